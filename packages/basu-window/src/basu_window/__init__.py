"""A window on a run: the head-up display, a person at the wheel, and Rerun's viewer."""
