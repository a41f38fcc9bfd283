"""`PageServer`: serves the page, the scene and the models by HTTP, and frames by WebSocket, on a loopback port.

The address holds a token; a request without it gets a sentence. The headers Host and Origin must name a loopback
address, so that no other site can reach the port through the browser.
"""

import asyncio
import base64
import gzip
import hashlib
import hmac
import json
import logging
import secrets
from collections.abc import Callable
from functools import cache as once
from http import HTTPStatus
from importlib import resources
from time import monotonic
from typing import Any
from urllib.parse import parse_qs, unquote, urlsplit

from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from linden_window.hub import Hub, PageQueue

log = logging.getLogger("linden")

LARGEST_ORDER = 16 * 1024
"""Bytes of one message of a page; the longest that the page sends has 300."""
ORDERS_EACH_S = 240
"""A page that steers sends 60 messages a second; more than four times as many are a flood."""
_WAITS_S = 10.0
"""A page that takes no byte for so long is closed."""
_LOOPBACK = ("127.0.0.1", "localhost", "[::1]")
_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".glb": "model/gltf-binary",
    ".json": "application/json",
    ".svg": "image/svg+xml",
    ".txt": "text/plain; charset=utf-8",
}
_POLICY = (
    "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; "
    "script-src 'self' '{hash}'; connect-src 'self' ws://{host}; object-src 'none'; base-uri 'none'"
)

_REPORT_POLICY = "sandbox allow-scripts; default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'"
"""Of reports in run folders: any network is forbidden, and their scripts cannot reach the window's pages."""

Found = bytes | None
Resources = Callable[[str, dict[str, str]], Found]
"""Returns the gzip-compressed content of a path below the token (``scene/1/tile-3.glb``) with its query, or None."""


class PageServer:
    """Serves one hub's pages.

    Attributes:
        token: the secret part of the address.
    """

    def __init__(self, hub: Hub, found: Resources, order: Callable[[dict[str, Any]], None]) -> None:
        """``found`` returns what is not a file of the page; ``order`` takes what pages send."""
        self._hub, self._found, self._order = hub, found, order
        self.token = secrets.token_urlsafe(18)
        self._server: Server | None = None
        self._port = 0
        self._numbers = 0

    async def start(self, host: str, port: int) -> str:
        """Open the port and return the page's address.

        Raises:
            OSError: the port is taken.
        """
        self._server = await serve(
            self._serve,
            host,
            port,
            process_request=self._answer,
            max_size=LARGEST_ORDER,
            max_queue=8,
            compression=None,
            server_header=None,
            ping_interval=20,
            logger=logging.getLogger("linden.window"),
        )
        self._port = next(iter(self._server.sockets)).getsockname()[1]
        return f"http://{host}:{self._port}/{self.token}/"

    async def close(self) -> None:
        """Close the port and all pages."""
        if self._server is not None:
            self._server.close()
            await self._server.wait_closed()

    # -- HTTP -----------------------------------------------------------------------------------------------------

    async def _answer(self, _connection: ServerConnection, request: Request) -> Response | None:
        """Answer a request; None lets the WebSocket begin."""
        parts = urlsplit(request.path)
        _, _, rest = parts.path.partition("/")
        token, slash, path = rest.partition("/")
        if not self._is_ours(request.headers.get("Host", "")):
            return _said(HTTPStatus.FORBIDDEN, "This address is not the window's own; open the one that was printed.")
        if not hmac.compare_digest(token.encode(), self.token.encode()):
            return _said(
                HTTPStatus.FORBIDDEN,
                "The address lacks the window's token, or the token is of an earlier start; copy the whole address "
                "that the program printed.",
            )
        if not slash:
            return _moved(f"/{self.token}/")
        if path == "live":
            return self._check_upgrade(request)
        query = {name: values[0] for name, values in parse_qs(parts.query).items()}
        content = await asyncio.to_thread(self._content, unquote(path) or "index.html", query)
        if content is None:
            return _said(HTTPStatus.NOT_FOUND, f"The window has no {path[:80]}.")
        return self._file(path or "index.html", content, request)

    def _check_upgrade(self, request: Request) -> Response | None:
        origin = request.headers.get("Origin")
        if origin is None or not self._is_ours(urlsplit(origin).netloc):
            return _said(HTTPStatus.FORBIDDEN, "Only the window's own page may open this connection.")
        return None

    def _is_ours(self, netloc: str) -> bool:
        name, colon, port = netloc.rpartition(":")
        # a tunnel may give the page another port, as in `ssh -L`; the name stays a loopback one
        return bool(colon) and name in _LOOPBACK and port.isdigit()

    def _content(self, path: str, query: dict[str, str]) -> Found:
        return self._found(path, query) if path.partition("/")[0] in ("scene", "model", "record") else page_file(path)

    def _file(self, path: str, content: bytes, request: Request) -> Response:
        suffix = path[path.rfind(".") :] if "." in path else ""
        headers = Headers()
        headers["Content-Type"] = _TYPES.get(suffix, "application/octet-stream")
        headers["Cache-Control"] = "no-store"
        headers["X-Content-Type-Options"] = "nosniff"
        headers["Referrer-Policy"] = "no-referrer"
        if suffix == ".html":
            policy = _POLICY.format(hash=_script_hash(), host=request.headers["Host"])
            headers["Content-Security-Policy"] = _REPORT_POLICY if path.startswith("record/") else policy
        if "gzip" in request.headers.get("Accept-Encoding", ""):
            headers["Content-Encoding"] = "gzip"
        else:
            content = gzip.decompress(content)
        headers["Content-Length"] = str(len(content))
        headers["Connection"] = "close"
        return Response(HTTPStatus.OK.value, HTTPStatus.OK.phrase, headers, content)

    # -- WebSocket ------------------------------------------------------------------------------------------------

    async def _serve(self, connection: ServerConnection) -> None:
        queue = self._hub.join()
        if queue is None:
            await connection.close(1013, "There are enough pages already; close one of them and load this page again.")
            return
        self._numbers += 1
        number = self._numbers
        self._tell_count()
        sending = asyncio.create_task(self._send(connection, queue))
        try:
            await self._receive(connection, number)
        except ConnectionClosed:
            pass
        finally:
            sending.cancel()
            self._hub.leave(queue)
            self._tell_count()
            self._order({"order": "left", "page": number})

    def _tell_count(self) -> None:
        self._order({"order": "pages", "count": len(self._hub)})

    async def _send(self, connection: ServerConnection, queue: PageQueue) -> None:
        """Send what waits for a page, whenever the page takes it."""
        try:
            while True:
                await queue.wakes.wait()
                if queue.is_overrun:
                    await connection.close(1011, "This page reads too slowly for this world.")  # it connects again
                    return
                for message in queue.take():
                    await asyncio.wait_for(connection.send(message), _WAITS_S)
        except ConnectionClosed:
            return
        except asyncio.TimeoutError:
            connection.transport.abort()

    async def _receive(self, connection: ServerConnection, number: int) -> None:
        """Take a page's orders, and close a page that floods."""
        since_s, count = monotonic(), 0
        async for message in connection:
            count += 1
            now_s = monotonic()
            if now_s - since_s >= 1.0:
                since_s, count = now_s, 1
            if count > ORDERS_EACH_S:
                await connection.close(1008, "This page sent too many messages; load it again.")
                return
            try:
                order = json.loads(message)
            except ValueError:
                order = None
            if not isinstance(order, dict) or not isinstance(order.get("order"), str):
                await connection.close(1008, "This page sent a message that is no order; load it again.")
                return
            if order["order"] not in ("pages", "left"):  # those are the server's own
                self._order({**order, "page": number})


def page_file(path: str) -> Found:
    """Return a file of the page, compressed; None if there is none of that name."""
    return _page_files().get(path)


@once
def _page_files() -> dict[str, bytes]:
    """Return the page's files by their paths."""
    found: dict[str, bytes] = {}
    waiting = [("", resources.files("linden_window") / "page")]
    while waiting:
        before, folder = waiting.pop()
        for entry in folder.iterdir():
            name = f"{before}{entry.name}"
            if entry.is_dir():
                waiting.append((f"{name}/", entry))
            else:
                found[name] = gzip.compress(entry.read_bytes(), 6, mtime=0)
    return found


@once
def _script_hash() -> str:
    """Return the hash of the one script inside of the page, for the browser's policy."""
    text = gzip.decompress(_page_files()["index.html"]).decode()
    script = text.split('<script type="importmap">', 1)[1].split("</script>", 1)[0]
    return f"sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}"


def _said(status: HTTPStatus, sentence: str) -> Response:
    """Return a page with one sentence."""
    body = f"<!doctype html><meta charset=utf-8><title>Window</title><p>{sentence}</p>".encode()
    headers = Headers()
    headers["Content-Type"] = _TYPES[".html"]
    headers["Content-Length"] = str(len(body))
    headers["Content-Security-Policy"] = "default-src 'none'"
    headers["Connection"] = "close"
    return Response(status.value, status.phrase, headers, body)


def _moved(to: str) -> Response:
    headers = Headers()
    headers["Location"] = to
    headers["Content-Length"] = "0"
    headers["Connection"] = "close"
    return Response(HTTPStatus.FOUND.value, HTTPStatus.FOUND.phrase, headers, b"")
