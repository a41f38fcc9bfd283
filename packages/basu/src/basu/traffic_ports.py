"""Ports of the benchmark's Traffic Managers: a range to which no agent's process can connect.

A Traffic Manager lives in the benchmark's process and obeys every connection. An agent that found its port could stop
all traffic. The ports are therefore known before an agent's process starts, and the kernel keeps the process away
from them (`basu.agents.process.confinement`).
"""

import itertools
import os
import socket

from basu.errors import UserError

TRAFFIC_PORTS = range(28000, 29000)

_tried = itertools.count(17 * os.getpid())  # processes side by side begin at ports of their own


def free_traffic_port() -> int:
    """Return a port of ``TRAFFIC_PORTS`` without a listener. Calls of one process return different ports.

    Raises:
        UserError: all ports of the range are in use.
    """
    for number in itertools.islice(_tried, len(TRAFFIC_PORTS)):
        port = TRAFFIC_PORTS[number % len(TRAFFIC_PORTS)]
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
        return port
    raise UserError(
        f"all ports from {TRAFFIC_PORTS[0]} to {TRAFFIC_PORTS[-1]} are in use, and traffic needs one: end other runs"
    )
