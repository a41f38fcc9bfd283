"""Many cases with many agents: two simulators beside each other, a folder with a matrix."""
