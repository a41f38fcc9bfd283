"""A browser for tests of pages. It is part of what `scripts/setup dev` makes ready: without one, the tests fail."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from playwright.sync_api import Browser, sync_playwright

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
# root has no sandbox; the rest keeps the browser from asking anybody for anything
SWITCHES = [
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


@contextmanager
def running_browser(*switches: str) -> Iterator[Browser]:
    """A Chromium without a window; ``switches`` replace the one that turns WebGL off."""
    found = next((path for path in map(shutil.which, NAMES) if path), None)
    if found is None:
        pytest.fail(
            f"no browser was found (looked for {', '.join(NAMES)}); `scripts/setup dev` installs one as root, "
            "otherwise: apt-get install chromium"
        )
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=[*SWITCHES, *(switches or ("--disable-gpu",))])
        try:
            yield browser
        finally:
            browser.close()
