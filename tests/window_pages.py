"""Requests for pages of a window, and pages in a browser."""

import gzip
import urllib.request
from typing import TYPE_CHECKING
from urllib.error import HTTPError

import numpy as np

from linden_window.poses import POSE, message, turns
from opendrive_texts import SIGNS_AND_LIGHTS

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

    from linden_window.link import PageLink

WAIT_MS = 120_000


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


CAR = {
    "id": 7, "type": "vehicle.tesla.model3", "choice": "", "kind": "vehicle", "parent": 0, "role": "hero",
    "colour": [200, 30, 30], "box": [0, 0, 0.7, 2.3, 0.95, 0.7], "fov": "",
}  # fmt: skip


def page_of(browser: "Browser", address: str, width: int = 900, height: int = 600) -> "Page":
    page = browser.new_page(viewport={"width": width, "height": height}, bypass_csp=True)
    page.errors = []
    page.on("pageerror", lambda error: page.errors.append(str(error)))
    page.on("request", lambda request: page.errors.append(request.url) if "127.0.0.1" not in request.url else None)
    page.set_default_timeout(WAIT_MS)
    page.goto(address, wait_until="commit")
    return page


def show(link: "PageLink", x_m: float, frame: int) -> None:
    rows = np.zeros(1, POSE)
    rows["id"], rows["place"], rows["rotation"] = 7, (x_m, 0.0, 0.0), turns(np.array([0.0, 10.0 * frame, 0.0]))
    rows["speed"] = 500
    link.frame(message(frame, frame * 0.05, rows))


def begin(link: "PageLink") -> None:
    link.note({"type": "map", "name": "Street", "text": SIGNS_AND_LIGHTS})
    link.note({"type": "actors", "spectator": 0, "actors": [CAR]})


def drive(link: "PageLink", page: "Page", frames: int) -> None:
    for frame in range(1, frames + 1):
        show(link, 0.5 * frame, frame)
        page.wait_for_timeout(30)
