"""Scores of detectors: read their output, slice the truth, compute average precision and track metrics."""
