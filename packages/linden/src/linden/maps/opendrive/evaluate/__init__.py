"""A map flattened into arrays, and evaluated for many places at once: reference lines, heights, lanes."""
