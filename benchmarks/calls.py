"""How long a small call takes, and how many a second there are, beside servers that only send a fixed answer back.

    python benchmarks/calls.py [--calls 20000]

Every figure is the best of five rounds, as the machine is shared. One client sends ``version``, the smallest call that
a handler answers: one call after the other, which is what scripts do, or 100 in a row before it reads the answers. The
limits answer without looking: one waits in ``recv``, the other in a selector, as a server of several clients must.
"""

import argparse
import multiprocessing
import selectors
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection

import msgpack

REQUEST = msgpack.packb([0, 1, "version", [[False]]])
ANSWER = msgpack.packb([1, 1, None, [[1, "0.9.16"]]])
ROUNDS = 5
IN_A_ROW = 100


def answer(client: socket.socket) -> bool:
    data = client.recv(65536)
    client.sendall(ANSWER * data.count(b"version"))
    return bool(data)


def blocking(port: Connection) -> None:
    with socket.create_server(("127.0.0.1", 0)) as door:
        port.send(door.getsockname()[1])
        client = eager(door.accept()[0])
        while answer(client):
            pass


def selecting(port: Connection) -> None:
    with socket.create_server(("127.0.0.1", 0)) as door, selectors.DefaultSelector() as selector:
        port.send(door.getsockname()[1])
        client = eager(door.accept()[0])
        selector.register(client, selectors.EVENT_READ)
        while all(answer(client) for _ in selector.select()):
            pass


def eager(client: socket.socket) -> socket.socket:
    client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return client


@contextmanager
def limit(work: Callable[[Connection], None]) -> Iterator[int]:
    ours, theirs = multiprocessing.Pipe()
    process = multiprocessing.Process(target=work, args=(theirs,), daemon=True)
    process.start()
    yield ours.recv()
    process.terminate()


@contextmanager
def linden() -> Iterator[int]:
    command = [sys.executable, "-m", "linden.cli", "serve", "--sync", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        ready = next(line for line in server.stdout if line.startswith("linden: ready"))
        yield int(ready.split("rpc port ")[1].split(",")[0])
        server.terminate()


def best_us(client: socket.socket, calls: int, in_a_row: int) -> float:
    """Microseconds a call."""
    rounds = []
    for _ in range(ROUNDS):
        began_s = time.perf_counter()
        for _ in range(calls // in_a_row):
            client.sendall(REQUEST * in_a_row)
            missing = len(ANSWER) * in_a_row
            while missing:
                missing -= len(client.recv(65536))
        rounds.append((time.perf_counter() - began_s) / calls * 1e6)
    return min(rounds)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--calls", type=int, default=20_000)
    calls = parser.parse_args().calls
    print(f"{'':26}us/call  calls/s   {IN_A_ROW} in a row: us/call   calls/s")
    servers = {
        "limit: waits in recv": limit(blocking),
        "limit: waits in a selector": limit(selecting),
        "linden": linden(),
    }
    for name, server in servers.items():
        with server as port, eager(socket.create_connection(("127.0.0.1", port))) as client:
            one, many = best_us(client, calls, 1), best_us(client, calls, IN_A_ROW)
        print(f"{name:26}{one:7.1f}{1e6 / one:9.0f}{many:25.2f}{1e6 / many:10.0f}", flush=True)


if __name__ == "__main__":
    main()
