"""Sockets, ports, sessions and the clock, in one thread; `rpc` holds the functions that clients call."""
