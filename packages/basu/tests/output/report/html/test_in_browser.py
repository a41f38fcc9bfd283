"""Claims about report.html in a real browser: it makes no request, opens its evidence, fits on paper and phones."""

from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, Page

from basu.output.report.html.page import report
from fakes.run_records import crashing, record

HOSTILE = "</title><script>document.title = 'owned'</script><img src=http://127.0.0.1:9/x onerror=alert(1)>"


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of a drive with three infractions, by an agent with a bad name."""
    path = tmp_path_factory.mktemp("run") / "report.html"
    path.write_bytes(report(record(crashing(), agent=HOSTILE, message=HOSTILE)))
    return path


def test_it_asks_no_actor_for_anything_and_does_not_complain(context: BrowserContext, file: Path) -> None:
    page = context.new_page()
    asked, said = [], []
    page.on("request", lambda request: asked.append(request.url))
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.goto(file.as_uri())
    page.locator("#plots summary").click()
    page.locator("#speed .plot").hover()
    assert asked == [file.as_uri()]
    assert said == []


def test_the_name_of_an_agent_is_text(page: Page) -> None:
    assert page.locator("h1").inner_text() == HOSTILE
    assert page.title().startswith("</title><script>")
    assert page.locator("img").count() == 0
    assert page.locator("script").count() == 2  # ours, and its samples


def test_a_mark_on_the_map_opens_its_evidence(page: Page) -> None:
    assert not page.locator("#infraction-3 dl").is_visible()
    page.locator('#map a[href="#infraction-3"]').click()
    evidence = page.locator("#infraction-3")
    assert evidence.locator("dl").is_visible()
    assert "hit static.poles at 15.00 m/s" in evidence.inner_text()
    assert evidence.locator("svg .own").is_visible()


def test_a_mark_can_be_reached_and_opened_by_keyboard(page: Page) -> None:
    for _ in range(10):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.hash") == "#infraction-3":
            break
    page.keyboard.press("Enter")
    page.locator("#infraction-3 dl").wait_for()  # the page opens it when it learns of the new fragment
    page.wait_for_function("document.activeElement.tagName === 'SUMMARY'")


def test_a_link_from_outside_opens_the_evidence(context: BrowserContext, file: Path) -> None:
    page = context.new_page()
    page.goto(f"{file.as_uri()}#infraction-2")
    page.locator("#infraction-2 dl").wait_for()
    assert not page.locator("#infraction-1 dl").is_visible()


def test_a_moment_in_a_plot_is_shown_on_the_map_and_in_all_plots(page: Page) -> None:
    assert page.locator("#here").is_hidden()
    page.locator("#plots summary").click()
    page.locator("#speed .plot").scroll_into_view_if_needed()
    box = page.locator("#speed .plot").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + box["width"] * 2.0 / 26.6, box["y"] + 50.0)  # 2 s of 26.6 s
    assert page.locator("#here").is_visible()
    assert page.locator("#now").inner_text().startswith("2.0 s of 26.6 s, 15 m/s")
    assert "15 m/s of 11" in page.locator("#speed .now").inner_text()
    assert page.locator("#jerk .cursor").is_visible()


def test_on_paper_all_evidence_is_open(page: Page) -> None:
    page.evaluate("""() => {
        window.open_then = null;
        addEventListener("beforeprint", () => {
            window.open_then = [...document.querySelectorAll(".evidence")].every((each) => each.open);
        });
    }""")
    assert page.pdf(format="A4").startswith(b"%PDF")
    assert page.evaluate("window.open_then") is True
    assert not page.locator("#infraction-1 dl").is_visible()  # and closed again afterwards


def test_a_phone_needs_no_scrolling_sideways(context: BrowserContext, file: Path) -> None:
    page = context.new_page()
    page.set_viewport_size({"width": 360, "height": 740})
    page.goto(f"{file.as_uri()}#infraction-1")
    page.evaluate("document.querySelectorAll('details').forEach((each) => { each.open = true; })")
    assert page.evaluate("document.documentElement.scrollWidth") <= 360


def test_it_can_be_read_without_its_script(browser: Browser, file: Path) -> None:
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(file.as_uri())
    page.locator("#infraction-1 summary").click()
    assert page.locator("#infraction-1 dl").is_visible()
    assert not page.locator(".moment").is_visible()  # nothing that does nothing
    context.close()


def test_the_replay_of_a_moment_is_a_command_in_a_file_and_a_link_at_the_window(browser: Browser, file: Path) -> None:
    page = browser.new_page()
    page.goto(f"{file.as_uri()}#infraction-3")
    replay = page.locator("#infraction-3 .replay")
    assert replay.locator("code").inner_text() == f"basu watch {file.parent} --at 4.7"
    assert not replay.locator("a").is_visible()
    page.locator("#moment").evaluate("(slider) => { slider.value = 0; slider.dispatchEvent(new Event('input')); }")
    assert page.locator("#replay code").inner_text() == f"basu watch {file.parent} --at 0.0"
    page.route("**/record/report-1.html", lambda route: route.fulfill(path=file))
    page.goto("http://127.0.0.1:9/token/record/report-1.html#infraction-3")
    assert replay.locator("a").get_attribute("href") == "../?t=4.7"
    assert replay.locator("a").is_visible()
    assert not replay.locator("code").is_visible()
    page.close()


@pytest.mark.parametrize(
    ("index", "is_shown"),
    [("../index.html", True), ("../../index.html", True), ("javascript:alert(1)", False), ("//a.b/index.html", False)],
)
def test_a_report_that_the_index_opened_links_back_to_it_and_nowhere_else(
    context: BrowserContext,
    file: Path,
    index: str,
    is_shown: bool,  # noqa: FBT001 - a case
) -> None:
    page = context.new_page()
    page.goto(f"{file.as_uri()}?index={index}#configuration")
    assert page.locator("#all-runs").is_visible() is is_shown
    assert page.locator("#all-runs").get_attribute("href") == (index if is_shown else None)
    assert page.locator("#configuration pre").is_visible(), "a link to the settings opens them"
