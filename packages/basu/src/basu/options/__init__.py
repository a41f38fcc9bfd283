"""The options of a run, by the groups of the help page. Each option is declared once."""
