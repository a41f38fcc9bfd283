"""The groups of options, as a help page names them."""

SIMULATOR, FOLDERS, ROUTES, CONDITIONS = "simulator", "run folders", "routes and scenarios", "conditions"
AGENT, WINDOW = "agent", "window and keys"
