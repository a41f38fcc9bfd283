"""Claims about the addresses and connections of pages: token, names, floods, slow pages, many pages."""

import asyncio
import json
import time
from urllib.parse import urlsplit

import numpy as np
import pytest
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidStatus

from linden.errors import UserError
from linden_window.hub import MOST_NOTES, MOST_PAGES, Hub
from linden_window.link import PageLink
from linden_window.page_server import LARGEST_ORDER, ORDERS_EACH_S, page_file
from linden_window.poses import POSE, message
from window_pages import fetched

FRAME = message(1, 0.05, np.zeros(3, POSE))


def live(address: str, origin: str | None = "http://127.0.0.1:1"):
    """Return the connection of a page; a browser sends its page's address as the origin.

    A connection that the server has given up waits one second, not ten, for a farewell at its end.
    """
    headers = {} if origin is None else {"Origin": origin}
    return connect(
        address.replace("http:", "ws:") + "live", additional_headers=headers, max_size=None, close_timeout=1.0
    )


def test_the_address_shows_the_page_and_all_that_it_loads(link: PageLink) -> None:
    status, kind, page = fetched(link.address)
    assert (status, kind) == (200, "text/html; charset=utf-8")
    for name in ("main.js", "style.css", "three/three.module.js", "three/three.core.js"):
        assert fetched(link.address + name)[0] == 200
    assert b"http" not in page.replace(b"<!doctype html>", b"")


def test_a_wrong_token_gets_a_sentence_and_no_file(link: PageLink) -> None:
    parts = urlsplit(link.address)
    for path in ("/", "/wrong/", "/wrong/main.js", "//", "/é/"):
        status, _, content = fetched(f"http://{parts.netloc}" + path.replace("é", "%C3%A9"))
        assert status == 403
        assert b"copy the whole address" in content


def test_another_host_name_gets_a_sentence(link: PageLink) -> None:
    status, _, content = fetched(link.address, {"Host": "evil.example:80"})
    assert status == 403
    assert b"not the window's own" in content


def test_a_file_that_does_not_exist_is_named(link: PageLink) -> None:
    for path in ("nothing.js", "../link.py", "scene/1/tile-0.glb", "record/frames.bin"):
        assert fetched(link.address + path.replace("..", "%2e%2e"))[0] == 404
    assert page_file("../link.py") is None


def test_another_site_cannot_open_the_connection(link: PageLink) -> None:
    async def attempt(origin: str | None) -> int:
        try:
            async with live(link.address, origin):
                return 101
        except InvalidStatus as error:
            return error.response.status_code

    assert asyncio.run(attempt("http://evil.example")) == 403
    assert asyncio.run(attempt(None)) == 403
    assert asyncio.run(attempt("http://localhost:8000")) == 101


def test_a_page_gets_frames_and_the_source_learns_how_many_pages_there_are(link: PageLink) -> None:
    async def watch() -> bytes | str:
        async with live(link.address) as page:
            wait_for(link, lambda orders: {"order": "pages", "count": 1} in orders)
            link.frame(FRAME)
            return await asyncio.wait_for(page.recv(), 20)

    assert asyncio.run(watch()) == FRAME


def wait_for(link: PageLink, holds, limit_s: float = 20.0) -> list[dict]:
    """Read orders until they are those expected."""
    until_s, found = time.monotonic() + limit_s, []
    while not holds(found):
        assert time.monotonic() < until_s, found
        found += link.orders()
    return found


def test_ten_pages_get_the_same_frame_and_one_too_many_gets_a_sentence(link: PageLink) -> None:
    async def watch() -> tuple[list[bytes | str], str]:
        pages = [await live(link.address) for _ in range(MOST_PAGES)]
        wait_for(link, lambda orders: {"order": "pages", "count": MOST_PAGES} in orders)
        link.frame(FRAME)
        got = [await asyncio.wait_for(page.recv(), 20) for page in pages]
        further = await live(link.address)
        with pytest.raises(ConnectionClosed) as closed:
            await further.recv()
        for page in pages:
            await page.close()
        return got, closed.value.rcvd.reason

    got, reason = asyncio.run(watch())
    assert MOST_PAGES >= 10
    assert got == [FRAME] * MOST_PAGES
    assert "enough pages" in reason


@pytest.mark.parametrize(
    ("messages", "sentence"),
    [
        (['{"order": "drive"}'] * (2 * ORDERS_EACH_S), "too many messages"),
        (["no JSON"], "no order"),
        (["[1, 2]"], "no order"),
        (['{"order": 5}'], "no order"),
        (["x" * (LARGEST_ORDER + 1)], ""),
    ],
    ids=["flood", "text", "list", "number", "huge"],
)
def test_a_hostile_page_is_closed_with_a_sentence_and_others_go_on(
    link: PageLink, messages: list[str], sentence: str
) -> None:
    async def flood() -> tuple[str, bytes | str]:
        async with live(link.address) as good, live(link.address) as bad:
            with pytest.raises(ConnectionClosed) as closed:
                await send_until_closed(bad, messages)
            link.orders()
            link.frame(FRAME)
            return closed.value.rcvd.reason, await asyncio.wait_for(good.recv(), 20)

    async def send_until_closed(page: ClientConnection, messages: list[str]) -> None:
        for each in messages:
            await page.send(each)
        while True:
            await asyncio.wait_for(page.recv(), 20)

    reason, frame = asyncio.run(flood())
    assert sentence in reason
    assert frame == FRAME


def test_a_page_that_does_not_read_delays_no_other_and_no_frame_of_the_source(link: PageLink) -> None:
    big = message(1, 0.05, np.zeros(3000, POSE))

    async def watch() -> tuple[float, int]:
        async with live(link.address) as slow, live(link.address) as good:
            slow.transport.pause_reading()
            wait_for(link, lambda orders: {"order": "pages", "count": 2} in orders)
            longest_s, got = 0.0, 0
            for _ in range(200):
                before_s = time.perf_counter()
                link.frame(big)
                longest_s = max(longest_s, time.perf_counter() - before_s)
                await asyncio.sleep(0)
            until_s = time.monotonic() + 20
            while got < 3 and time.monotonic() < until_s:
                link.frame(big)
                got += len(await asyncio.wait_for(good.recv(), 20)) == len(big)
            slow.transport.resume_reading()
            return longest_s, got

    longest_s, got = asyncio.run(watch())
    assert got == 3
    assert longest_s < 1.0  # a page that blocks the source would hold it for the ten seconds until it is closed


def test_orders_of_control_are_refused_unless_the_window_was_started_for_them(link: PageLink) -> None:
    async def order() -> dict:
        async with live(link.address) as page:
            await page.send('{"order": "weather", "values": {}}')
            return json.loads(await asyncio.wait_for(page.recv(), 20))

    assert "--window-control" in asyncio.run(order())["text"]
    assert "weather" not in {order["order"] for order in link.orders()}


def test_pages_learn_that_the_source_has_ended(link: PageLink) -> None:
    async def end() -> dict:
        async with live(link.address) as page:
            wait_for(link, lambda orders: {"order": "pages", "count": 1} in orders)
            await asyncio.to_thread(link.close)
            return json.loads(await asyncio.wait_for(page.recv(), 20))

    assert asyncio.run(end())["type"] == "end"


def test_a_port_that_is_taken_gets_a_sentence(link: PageLink) -> None:
    taken = urlsplit(link.address).port
    with pytest.raises(UserError, match=f"port {taken} cannot be opened"):
        PageLink.start(port=taken)


def test_a_source_with_a_process_that_has_died_goes_on(link: PageLink) -> None:
    link._process.kill()
    link._process.wait()
    for _ in range(3):
        link.frame(FRAME)
        link.note({"type": "says", "text": "unheard"})
        link.orders()
    assert not link.is_open


def test_a_new_page_gets_the_last_note_of_each_kind() -> None:
    hub = Hub()
    hub.note({"type": "scene", "number": 1})
    hub.note({"type": "weather", "weather": 1})
    hub.note({"type": "weather", "weather": 2})
    assert [json.loads(note)["type"] for note in hub.join().take()] == ["scene", "weather"]
    hub.note({"type": "scene", "number": 1, "ready": True})
    assert len(hub.join().take()) == 2
    hub.note({"type": "scene", "number": 2})
    assert len(hub.join().take()) == 1


def test_a_slow_page_has_the_newest_frame_and_is_closed_before_notes_fill_the_memory() -> None:
    hub = Hub()
    page = hub.join()
    hub.frame(b"old")
    hub.frame(b"new")
    assert (page.take(), page.dropped) == ([b"new"], 1)
    for number in range(MOST_NOTES + 1):
        hub.note({"type": "says", "text": str(number)})
    assert page.is_overrun
    assert len(page.notes) == MOST_NOTES
