"""Experiments: what was measured once and is written down, driven again and put beside it."""
