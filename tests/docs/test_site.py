"""The documentation site builds strictly, has every page, loads nothing from other hosts, and fits a phone."""

import re
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest
from playwright.sync_api import Browser

from browsers import running_browser
from docs.pages import ROOT
from tracing import untraced

LOADED = re.compile(r"<(?:script|img|iframe)[^>]*\bsrc=\"?(https?:)?//|<link[^>]*\bhref=\"?(https?:)?//[^>]*stylesheet")


def build(folder: Path, *options: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder), *options]
    with untraced():  # it reads our sources and runs none of them
        return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    done = build(folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with running_browser() as found:
        yield found


class Quiet(SimpleHTTPRequestHandler):
    """Lets the browser keep what it has: each page has the same style and program."""

    def log_message(self, *arguments: object) -> None:
        pass

    def end_headers(self) -> None:
        self.send_header("Cache-Control", "max-age=600")
        super().end_headers()


class WithoutSearch(Quiet):
    """Has no search, of which each page would make the index of all pages anew."""

    def do_GET(self) -> None:
        if self.path.startswith("/search/"):
            self.send_error(404)
        else:
            super().do_GET()


@contextmanager
def serving(site: Path, handler: type[Quiet]) -> Iterator[str]:
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(handler, directory=str(site)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    server.server_close()


@pytest.fixture(scope="module")
def address(site: Path) -> Iterator[str]:
    with serving(site, Quiet) as found:
        yield found


def pages(site: Path) -> list[str]:
    return sorted(str(path.relative_to(site)) for path in site.rglob("*.html") if path.name != "404.html")


def test_each_page_of_the_docs_is_in_the_site_and_in_the_menu(site: Path) -> None:
    written = {str(path.relative_to(ROOT / "docs").with_suffix(".html")) for path in (ROOT / "docs").rglob("*.md")}
    assert written == set(pages(site))
    start = (site / "index.html").read_text("utf-8")
    assert {page for page in written if f'href="{page}"' not in start and not page.startswith("decisions/")} == set()
    decision = (site / "decisions" / "index.html").read_text("utf-8")
    assert {page for page in written if page.startswith("decisions/0") and Path(page).name not in decision} == set()


def test_a_broken_link_stops_the_build(tmp_path: Path) -> None:
    docs = tmp_path / "docs"
    docs.mkdir()
    (docs / "index.md").write_text("[a page](no-such-page.md)\n", "utf-8")
    config = tmp_path / "mkdocs.yml"
    validation = re.search(r"^validation:\n(?:  .*\n)+", (ROOT / "mkdocs.yml").read_text("utf-8"), re.MULTILINE)
    assert validation is not None
    config.write_text(f"site_name: a test\n{validation[0]}", "utf-8")
    done = build(tmp_path / "site", "--config-file", str(config))
    assert done.returncode != 0
    assert "no-such-page.md" in done.stdout + done.stderr


def test_no_page_loads_anything_from_another_host(site: Path) -> None:
    assert not [page for page in pages(site) if LOADED.search((site / page).read_text("utf-8"))]
    styles = [path.read_text("utf-8") for path in site.rglob("*.css")]
    assert styles
    assert not [style for style in styles if re.search(r"url\(['\"]?https?:|@import", style)]


def test_the_search_finds_a_page_without_a_request_to_another_host(browser: Browser, address: str) -> None:
    page = browser.new_page()
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto(address)
    page.keyboard.press("/")
    page.keyboard.type("disengagement")
    page.wait_for_selector(".md-search-result__link >> text=/metrics|judged|scor/i", timeout=20_000)
    page.close()
    assert asked
    assert not [url for url in asked if not url.startswith((address, "blob:", "data:"))]


def test_no_page_is_wider_than_a_phone(browser: Browser, site: Path) -> None:
    page = browser.new_page(viewport={"width": 390, "height": 800})
    wide = []
    with serving(site, WithoutSearch) as address:
        for name in pages(site):
            page.goto(f"{address}/{name}", wait_until="domcontentloaded")
            if page.evaluate("document.documentElement.scrollWidth") > 390:
                wide.append(name)
        page.close()
    assert not wide
