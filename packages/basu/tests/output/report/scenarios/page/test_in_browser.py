"""Claims about matrix.html in a real browser: it makes no request, opens cards, filters, fits on phones and paper."""

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, expect

from basu.metrics.boxes import own_boxes
from basu.output.report.scenarios.drawing.canvas import canvas_for, what_matters
from basu.output.report.scenarios.drawing.encounter import story_of
from basu.output.report.scenarios.matrix_documents import CaseRecord
from basu.output.report.scenarios.page.matrix_page import Cell, matrix_page
from fakes.scenario_documents import NAMED, case_result, crossing, failed, matrix, told

CARD = "#case-pedestrian_crossing_2--basic"


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of fifteen cases with three agents, one of which broke down once."""
    good, bad = crossing(), crossing(brakes=False)

    def left(cell: Cell) -> CaseRecord | str:
        verdict = cell.case["results"][cell.agent]["verdict"]
        document = case_result if verdict == "SUCCESS" else failed
        result = document(id=cell.case["id"], agent=cell.agent, verdict=verdict)
        return CaseRecord(case=result, result=None, history=good if verdict == "SUCCESS" else bad, streets=NAMED)

    matrix_ = matrix()
    matrix_["cases"][0]["results"]["basic"] = told("AGENT_FAULT", "x", "basic", 1.0)
    path = tmp_path_factory.mktemp("run") / "matrix.html"
    path.write_bytes(matrix_page(matrix_, left))
    return path


def test_it_asks_no_actor_for_anything_and_does_not_complain(context: BrowserContext, file: Path) -> None:
    page = context.new_page()
    asked, complaints = [], []
    page.on("request", lambda request: asked.append(request.url))
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(file.as_uri())
    page.locator("#by-verdict").select_option("FAILURE")
    assert asked == [file.as_uri()]
    assert complaints == []


def test_a_sign_in_the_matrix_opens_its_card(page: Page) -> None:
    assert not page.locator(f"{CARD} svg.case-picture").is_visible()
    page.locator(f'.matrix a[href="{CARD}"]').click()
    assert page.locator(f"{CARD} svg.case-picture").is_visible()
    assert page.evaluate("document.activeElement.tagName") == "SUMMARY"


def test_a_link_from_outside_opens_the_card(context: BrowserContext, file: Path) -> None:
    page = context.new_page()
    page.goto(f"{file.as_uri()}{CARD}")
    assert page.locator(f"{CARD} .judgements").is_visible()


def test_cases_are_shown_by_verdict_agent_and_group(page: Page) -> None:
    assert page.locator("#shown").inner_text() == "45 shown"
    page.locator("#by-verdict").select_option("AGENT_FAULT")
    assert page.locator("#shown").inner_text() == "1 shown"
    assert page.locator("details.case:visible").count() == 1
    page.locator("#by-verdict").select_option("")
    page.locator("#by-agent").select_option("forward")
    page.locator("#by-group").select_option("pedestrian")
    assert page.locator("#shown").inner_text() == "6 shown"
    page.locator("#open").click()
    assert page.locator(".case-card:visible").count() == 6
    assert set(page.locator(".case-card:visible").evaluate_all("all => all.map(c => c.dataset.agent)")) == {"forward"}


def test_a_link_to_a_card_that_is_hidden_shows_it(page: Page) -> None:
    page.locator("#by-agent").select_option("forward")
    page.locator(f'.matrix a[href="{CARD}"]').click()
    assert page.locator(CARD).is_visible()
    assert page.locator("#by-agent").input_value() == ""


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_words_can_be_read_on_what_they_stand(browser: Browser, file: Path, scheme: str) -> None:
    """WCAG 2.2, 1.4.3: contrast of at least 4.5 for the verdicts and the words of a card."""
    context = browser.new_context(color_scheme=scheme)
    page = context.new_page()
    page.goto(f"{file.as_uri()}{CARD}")
    ratios = page.evaluate("""() => {
      const parts = (text) => text.match(/[0-9.]+/g).map(Number);
      const light = (c) => {
        const [r, g, b] = c.slice(0, 3).map((v) => (v /= 255) <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
        return 0.2126 * r + 0.7152 * g + 0.0722 * b;
      };
      const ground = (e) => {
        for (; e; e = e.parentElement) {
          const c = parts(getComputedStyle(e).backgroundColor);
          if (c.length < 4 || c[3] > 0.5) return c;
        }
        return [255, 255, 255];
      };
      return [...document.querySelectorAll(".verdict, .chip, .share, .message, .judgements td, small, .note")]
        .filter((e) => e.textContent.trim())
        .map((e) => {
          const [a, b] = [light(parts(getComputedStyle(e).color)), light(ground(e))].sort((x, y) => y - x);
          return (a + 0.05) / (b + 0.05);
        });
    }""")
    context.close()
    assert len(ratios) > 100
    assert min(ratios) >= 4.5


def test_a_phone_needs_no_scrolling_sideways(context: BrowserContext, file: Path) -> None:
    page = context.new_page()
    page.set_viewport_size({"width": 360, "height": 740})
    page.goto(f"{file.as_uri()}{CARD}")
    page.evaluate("document.querySelectorAll('details').forEach((each) => { each.open = true; })")
    assert page.evaluate("document.documentElement.scrollWidth") <= 360


def test_it_can_be_read_without_its_script(browser: Browser, file: Path) -> None:
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(file.as_uri())
    page.locator("details.case summary").first.click()
    assert page.locator("svg.case-picture").first.is_visible()
    assert not page.locator(".filters").is_visible()  # nothing that does nothing
    assert not page.locator(".film-bar").first.is_visible()
    context.close()


def test_on_paper_there_are_matrix_and_opened_cases(page: Page) -> None:
    page.locator(f'.matrix a[href="{CARD}"]').click()
    page.emulate_media(media="print")
    assert page.locator(".matrix").first.is_visible()
    assert page.locator("details.case:visible").count() == 1
    assert not page.locator(".filters").is_visible()


def moved_to(page: Page, seconds: float) -> None:
    slider = page.locator(f"{CARD} .film-bar input")
    slider.evaluate("(s, to) => { s.value = to; s.dispatchEvent(new Event('input')); }", seconds)


def test_the_slider_of_a_film_moves_the_ego_to_its_place_of_the_record(context: BrowserContext, file: Path) -> None:
    page = context.new_page()
    page.goto(f"{file.as_uri()}{CARD}")
    assert page.locator(f"{CARD} .moment").is_visible()
    result, history = failed(), crossing(brakes=False)
    canvas = canvas_for(what_matters(story_of(result, history)))
    for seconds in (6.0, 7.0):
        moved_to(page, seconds)
        assert not page.locator(f"{CARD} .moment").is_visible()
        assert page.locator(f"{CARD} .film-bar output").inner_text().startswith(f"{seconds:.1f} s, ego at ")
        middle = own_boxes(history.facts, history.frames[round(seconds / 0.05)][None])[0]
        placed = page.locator(f"{CARD} .film .own").get_attribute("transform") or ""
        x_px, y_px = (float(text) for text in re.findall(r"[-0-9.]+", placed)[:2])
        assert (x_px, y_px) == pytest.approx(canvas.at(middle[0], middle[1]), abs=0.7)


def test_a_film_plays_to_its_end_and_the_still_picture_comes_back(context: BrowserContext, file: Path) -> None:
    page = context.new_page()
    page.goto(f"{file.as_uri()}{CARD}")
    slider = page.locator(f"{CARD} .film-bar input")
    end_s = float(slider.get_attribute("max") or "nan")
    moved_to(page, end_s - 0.3)
    page.locator(f"{CARD} .play").click()
    expect(page.locator(f"{CARD} .film-bar output")).to_contain_text(f"{end_s:.1f} s, ego at", timeout=20_000)
    expect(page.locator(f"{CARD} .play")).to_have_text("Play")
    page.locator(f"{CARD} .still").click()
    assert page.locator(f"{CARD} .moment").is_visible()
    assert page.locator(f"{CARD} .film-bar output").inner_text() == ""
