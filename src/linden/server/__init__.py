"""Sockets, ports and the clock: one thread that waits for whatever comes next."""
