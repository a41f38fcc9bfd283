"""Requests for pages of a window."""

import gzip
import urllib.request
from urllib.error import HTTPError


def fetched(address: str, headers: dict[str, str] | None = None) -> tuple[int, str, bytes]:
    """Return status, type and content of an address."""
    request = urllib.request.Request(address, headers={"Accept-Encoding": "gzip", **(headers or {})})
    try:
        with urllib.request.urlopen(request, timeout=60) as answer:
            content = answer.read()
            status, kind = answer.status, answer.headers["Content-Type"]
            if answer.headers["Content-Encoding"] == "gzip":
                content = gzip.decompress(content)
    except HTTPError as error:
        return error.code, error.headers["Content-Type"], error.read()
    return status, kind, content
