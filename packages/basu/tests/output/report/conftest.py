"""A real browser for the pages; a file that asks for ``page`` says with its own ``file`` which one."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, Page

from browsers import running_browser


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with running_browser() as running:
        yield running


@pytest.fixture
def context(browser: Browser) -> Iterator[BrowserContext]:
    context = browser.new_context(offline=True)
    yield context
    context.close()


@pytest.fixture
def page(context: BrowserContext, file: Path) -> Page:
    """The page, open."""
    page = context.new_page()
    page.goto(file.as_uri())
    return page
