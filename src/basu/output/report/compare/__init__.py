"""Runs side by side, as table 5.1 and figure 5.3 of the thesis show agents: as text, page and picture."""
