"""Claims about what a person reads in a real browser when something goes wrong, while the world goes on."""

from collections.abc import Iterator
from pathlib import Path

import carla
import pytest
from playwright.sync_api import Browser

from browsers import running_browser
from linden_window.hub import MOST_PAGES
from linden_window.link import PageLink
from opendrive_texts import SIGNS_AND_LIGHTS
from served_windows import Served, serving
from window_pages import CAR, begin, page_of, show

SAYS = "document.getElementById('says').innerText.includes({words!r})"
GETS_FRAMES = "page.timeline.frames.length > {count}"


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with running_browser() as found:
        yield found


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("maps")
    (folder / "Street.xodr").write_text(SIGNS_AND_LIGHTS)
    with serving("--maps", folder, "--map", "Street", "--window") as found:
        yield found


def test_a_wrong_token_says_what_to_copy(link: PageLink, browser: Browser) -> None:
    begin(link)
    page = browser.new_page()
    page.goto(link.address.rsplit("/", 2)[0] + "/not-the-token/")
    assert "copy the whole address that the program printed" in page.inner_text("body")
    page.close()


def test_a_map_that_cannot_be_read_says_so_and_shows_actors(link: PageLink, browser: Browser) -> None:
    link.note({"type": "map", "name": "Broken", "text": "<OpenDRIVE><road"})
    link.note({"type": "actors", "spectator": 0, "actors": [CAR]})
    page = page_of(browser, link.address)
    page.wait_for_function("globalThis.page && " + SAYS.format(words="The map has no scenery"))
    for frame in range(1, 6):
        show(link, 0.5 * frame, frame)
        page.wait_for_timeout(50)
    page.wait_for_function("page.poses.length === 1")
    assert page.errors == []
    page.close()


@pytest.mark.slow
def test_ten_pages_at_once_see_the_same_world_and_one_too_many_reads_why(browser: Browser, served: Served) -> None:
    pages = [page_of(browser, served.address + "?flat", 300, 300) for _ in range(MOST_PAGES)]
    for page in pages:
        page.wait_for_function("globalThis.page && " + GETS_FRAMES.format(count=5))
    further = page_of(browser, served.address + "?flat", 300, 300)
    further.wait_for_function("globalThis.page && " + SAYS.format(words="There are enough pages already"))
    assert all(page.errors == [] for page in pages)
    for page in [*pages, further]:
        page.close()


def test_a_page_that_floods_reads_why_it_was_closed_and_the_world_goes_on(browser: Browser, served: Served) -> None:
    good, bad = (page_of(browser, served.address + "?flat", 300, 300) for _ in range(2))
    for page in (good, bad):
        page.wait_for_function("globalThis.page && " + GETS_FRAMES.format(count=2))
    bad.evaluate("for (let sent = 0; sent < 2000; sent++) page.connection.send({ order: 'drive', held: [] })")
    bad.wait_for_function(SAYS.format(words="too many messages"))
    count = good.evaluate("page.timeline.frames.length")
    good.wait_for_function(GETS_FRAMES.format(count=count + 5))
    client = carla.Client("127.0.0.1", served.port)
    client.set_timeout(60.0)
    world = client.get_world()
    assert world.wait_for_tick().frame < world.wait_for_tick().frame
    good.close()
    bad.close()


def test_a_page_that_only_watches_cannot_change_the_world(browser: Browser, served: Served) -> None:
    page = page_of(browser, served.address + "?flat", 600, 400)
    page.wait_for_function("globalThis.page && " + GETS_FRAMES.format(count=2))
    assert not page.is_visible("#control")
    page.evaluate("page.connection.send({ order: 'pause', on: true })")
    page.wait_for_function(SAYS.format(words="--window-control"))
    page.close()


def test_the_page_names_a_server_that_was_killed(browser: Browser, tmp_path: Path) -> None:
    (tmp_path / "Street.xodr").write_text(SIGNS_AND_LIGHTS)
    with serving("--maps", tmp_path, "--map", "Street", "--window") as served:
        page = page_of(browser, served.address + "?flat", 600, 400)
        page.wait_for_function("globalThis.page && " + GETS_FRAMES.format(count=2))
        served.process.kill()
        page.wait_for_function(SAYS.format(words="has ended. Start it again"))
        page.close()
