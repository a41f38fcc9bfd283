"""Claims about drives in a real browser: a person at the keyboard and at a gamepad, and the slider of a record."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser

from basu.output.report.html.page import write_report
from basu.records.history.files import read_history
from basu_fixtures import SHORT_ROUTE
from browsers import running_browser
from fakes.run_records import crashing, record, written
from opendrive_texts import SIGNS_AND_LIGHTS
from page_drives import PAD, WHEEL, started
from window_pages import page_of


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with running_browser() as found:
        yield found


def test_a_record_plays_with_slider_marks_and_panel(browser: Browser, tmp_path: Path) -> None:
    folder = written(tmp_path / "a-run", record(crashing()))
    write_report(folder, record(crashing()))
    (folder / "config.json").unlink()  # its fake has no scoring, and the default is meant
    (tmp_path / "street.xodr").write_text(SIGNS_AND_LIGHTS)
    with started("watch", folder, "--map", tmp_path / "street.xodr") as (_, address):
        page = page_of(browser, address + "?flat&t=10")
        page.wait_for_function("globalThis.page?.replay.isOn && page.poses.length === 1")
        assert page.evaluate("page.timeline.frames.length") == len(crashing().frames)
        assert page.locator("#ticks button").count() == 3
        page.wait_for_function("document.getElementById('score').innerText.includes('stop sign')")
        page.locator("#ticks button").first.click(force=True)
        before = page.evaluate("page.replay.clock")
        page.keyboard.press("ArrowRight")
        page.wait_for_function(f"page.replay.clock > {before}")
        page.keyboard.press("Space")
        page.wait_for_function(f"page.replay.clock > {before} + 1")
        page.click("#reports a")
        page.click('#map a[href="#infraction-3"]')
        page.click("#infraction-3 .replay a")
        page.wait_for_function("globalThis.page?.replay.isOn && page.poses.length === 1")
        assert page.evaluate("page.replay.clock") == pytest.approx(4.7)
        assert page.errors == []
        page.close()


@pytest.mark.slow
def test_a_person_drives_by_keyboard_gamepad_and_wheel(browser: Browser, tmp_path: Path) -> None:
    words = ("run", "human", "--watch", "--routes", SHORT_ROUTE, "--output", tmp_path)
    with started(*words) as (process, address):
        page = page_of(browser, address + "?flat")
        speed = "(page.followed()?.speed ?? 0)"
        page.wait_for_function("globalThis.page?.input.isOn && page.poses.length > 0")
        page.keyboard.down("w")
        page.wait_for_function(f"{speed} > 2")
        page.keyboard.up("w")
        page.keyboard.down(" ")
        page.keyboard.down("s")
        page.wait_for_function(f"{speed} < 0.1")
        page.keyboard.up("s")
        page.keyboard.up(" ")
        page.evaluate(PAD.format(steer=0.0, throttle=0.8, brake=0))
        page.wait_for_function(f"{speed} > 2")
        page.evaluate(PAD.format(steer=0.5, throttle=0, brake=1))
        page.wait_for_function(f"{speed} < 0.1")
        page.evaluate(WHEEL.format(steer=0, throttle=1, brake=1))  # its pedals rest at 1 and are pressed at -1
        page.wait_for_timeout(200)
        page.evaluate(WHEEL.format(steer=0.1, throttle=-1, brake=1))
        page.wait_for_function(f"{speed} > 2")
        page.evaluate(WHEEL.format(steer=0.1, throttle=1, brake=-1))
        page.wait_for_function(f"{speed} < 0.1")
        assert "a person" in page.inner_text("#score")
        assert page.errors == []
        page.keyboard.press("Escape")
        process.communicate(timeout=120)
        page.close()
    (folder,) = [each for each in tmp_path.iterdir() if (each / "history.parquet").exists() and not each.is_symlink()]
    frames = read_history(folder).frames
    assert frames["manual"].all()
    assert frames["applied_throttle"].max() > 0.9  # of the key
    assert frames["applied_steer"].max() > 0.4  # of the stick
    assert frames["applied_hand_brake"].any()
