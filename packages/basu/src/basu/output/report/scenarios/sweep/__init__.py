"""Sampled parameters: where an agent begins to fail, in sentences with counts and as a map."""
