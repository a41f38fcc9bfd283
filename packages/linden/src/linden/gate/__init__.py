"""The gate: what an agent's client may call, and what it sees of others; bytes and calls in, bytes out, no sockets.

A gate stands between one agent and a server. The server's own gate session and the relay ``linden gate`` use it alike.
"""
