"""The head-up display: a window on a run, and the seat of the person before it."""
