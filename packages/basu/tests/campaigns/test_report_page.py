"""Claims about campaign.html in a browser: nothing is wider than a screen, a phone or a sheet, and headings stay."""

import importlib
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page

from basu.campaigns import command
from basu.campaigns.campaign_run import RunSettings
from basu.campaigns.command import run_campaign
from basu.campaigns.records import FAILURE, folder_of, kept_in
from basu.campaigns.report import write_campaign_report
from basu.files import read_json
from basu.output.report.documents import RESULT_FILE, write_json
from basu.output.report.streets import write_streets
from basu.records.history.files import write_history
from browsers import running_browser
from fakes.scenario_documents import NAMED, crossing, failed

WIDE = """() => [...document.querySelectorAll("body *")].filter(each => {
    if (each.ownerSVGElement) return false;  // the picture cuts off what is inside it
    const box = each.getBoundingClientRect();
    if (box.width === 0 || (box.left > -1 && box.right < document.documentElement.clientWidth + 1)) return false;
    for (let at = each.parentElement; at; at = at.parentElement)
        if (["auto", "scroll"].includes(getComputedStyle(at).overflowX)) return false;
    return true;
}).map(each => each.outerHTML.slice(0, 120))"""
A4_PX = 718  # between margins of 10 mm, at 96 px an inch
LONG = "hit walker (walker.pedestrian.0012), which had 1.22 m/s, at 12.15 s at 6.71 m/s; " * 3 + "x" * 90


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with running_browser() as running:
        yield running


@pytest.fixture
def page_file(
    campaign: Callable[..., Path], modules: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, here: None
) -> Path:
    """The page of a campaign with pictures, a long message, and a record that another version has left."""
    monkeypatch.setattr(command, "drive_player", importlib.import_module(modules).spec)
    assert run_campaign(RunSettings(file=campaign(), output=tmp_path / "campaigns", workers=1)) == 0
    folder = tmp_path / "campaigns" / "crossings"
    kept = kept_in(folder)
    for each in kept[1:]:
        at = folder_of(folder, each)
        write_history(at, crossing(brakes=False))
        write_streets(at, NAMED)
        write_json(at / RESULT_FILE, {**failed(), "schema_version": 2})
    worst = min(kept[1:], key=lambda each: (each.reason != FAILURE, -each.severity, each.number))
    told = folder_of(folder, worst) / "drive.json"
    document = read_json(told, "the document")
    write_json(told, {**document, "row": {**document["row"], "message": LONG}})
    return write_campaign_report(folder)


def test_the_page_fits_a_screen_a_phone_and_a_sheet(browser: Browser, page_file: Path) -> None:
    text = page_file.read_text(encoding="utf-8")
    assert "no picture: " in text  # of the record that cannot be read; the reason stands beside it
    assert LONG in text
    for width, media in ((1280, "screen"), (390, "screen"), (A4_PX, "print")):
        context = browser.new_context(offline=True, viewport={"width": width, "height": 900})
        page = context.new_page()
        page.goto(page_file.as_uri())
        page.emulate_media(media=media)
        assert page.locator(".worst svg").count() > 4
        assert page.evaluate(WIDE) == [], (width, media)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        if media == "print":
            _check_print(page)
        context.close()


def _check_print(page: Page) -> None:
    """Whether headings stay with what follows, and whether it prints."""
    for heading in ("h2", "h3"):
        breaks = page.locator(heading).evaluate_all("all => all.map(each => getComputedStyle(each).breakAfter)")
        assert set(breaks) == {"avoid"}
    assert page.pdf(format="A4").startswith(b"%PDF")
