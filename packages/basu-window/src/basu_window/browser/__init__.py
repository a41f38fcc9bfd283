"""The window of the benchmark: live drives and recorded ones in the page of :mod:`linden_window`."""
