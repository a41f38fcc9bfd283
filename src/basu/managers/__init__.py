"""The managers of the thesis: each holds one concern of a run and delegates the thinking."""
