"""The functions that a client can call, one family a module."""
