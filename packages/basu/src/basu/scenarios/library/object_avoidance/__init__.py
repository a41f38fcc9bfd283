"""Something is in the way: scenario III of the thesis, static and dynamic."""
