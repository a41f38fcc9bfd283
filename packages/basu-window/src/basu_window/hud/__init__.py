"""The head-up display: a window on a run, and the input of the person before it."""
