"""Typed settings: each option is declared once and read from the command line, a file or Python by the same rules."""
