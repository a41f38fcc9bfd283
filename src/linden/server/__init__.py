"""Sockets, ports and the clock: the only place that knows there is a network."""
