"""The process of the pages: reads frames from its parent's socket and serves them; see :mod:`linden_window.link`."""

import argparse
import asyncio
import json
import logging
import os
import signal
import socket
import sys
from typing import Any

from linden_window.link import BLOB, FRAME, NOTE, PANE, PREFIX

log = logging.getLogger("linden")
LINGERS_S = 1.0
"""How long pages may still read the sentence about the end."""


def main() -> int:
    """Serve until the parent's end of the socket is closed."""
    parser = argparse.ArgumentParser(prog="python -m linden_window", description=__doc__)
    parser.add_argument("--link", type=int, required=True, help="number of the socket")
    parser.add_argument("--host", default="127.0.0.1", help="loopback address")
    parser.add_argument("--port", type=int, default=0, help="port of the pages")
    parser.add_argument("--control", action="store_true", help="take orders that change the world")
    arguments = parser.parse_args()
    logging.basicConfig(level=logging.WARNING, format="linden: %(levelname)s: %(message)s")
    logging.getLogger("linden.window").setLevel(logging.CRITICAL)  # requests that a browser breaks off are no news
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends us
    link = socket.socket(fileno=arguments.link)
    os.set_inheritable(link.fileno(), False)
    return asyncio.run(_serve(link, arguments))


async def _serve(link: socket.socket, arguments: argparse.Namespace) -> int:
    from linden_window.window import Window  # noqa: PLC0415 - after the arguments are known to be right

    reader, writer = await asyncio.open_connection(sock=link)

    def order(value: dict[str, Any]) -> None:
        if not writer.is_closing():
            writer.write(json.dumps(value, separators=(",", ":")).encode() + b"\n")

    window = Window(order, may_control=arguments.control)
    try:
        address = await window.start(arguments.host, arguments.port)
    except OSError as error:
        order({"error": f"the window's port {arguments.port} cannot be opened ({error.strerror}); name another"})
        await writer.drain()
        return 2
    order({"address": address})
    try:
        while True:
            kind, length = PREFIX.unpack(await reader.readexactly(PREFIX.size))
            content = await reader.readexactly(length)
            if kind == FRAME:
                window.frame(content)
            elif kind == NOTE:
                window.note(json.loads(content))
            elif kind in (PANE, BLOB):
                name, _, file = content.partition(b"\n")
                (window.pane if kind == PANE else window.keep)(name.decode(), file)
    except (asyncio.IncompleteReadError, ConnectionError):
        pass
    window.end()
    await asyncio.sleep(LINGERS_S)
    await window.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
