"""Claims about matrix.html as a file: self-contained, complete, small, and true to what words of others say."""

import html
import re
from pathlib import Path
from typing import Any

import pytest

from basu.output.report.documents import RESULT_FILE, write_json
from basu.output.report.scenarios.matrix_documents import CaseRecord
from basu.output.report.scenarios.page import matrix_page as module
from basu.output.report.scenarios.page.matrix_page import PAGE_FILE, Cell, chosen, matrix_page, write_matrix_page
from basu.output.report.streets import write_streets
from basu.records.history.files import write_history
from fakes.scenario_documents import NAMED, case, case_result, crossing, failed, matrix, matrix_of, sweep, told

GOOD, BAD = crossing(), crossing(brakes=False)


def left(cell: Cell) -> CaseRecord | str:
    """What a case of `matrix` would have left."""
    verdict = cell.case["results"][cell.agent]["verdict"]
    if verdict not in {"SUCCESS", "FAILURE"}:
        return "It left no folder."
    document = case_result if verdict == "SUCCESS" else failed
    result = document(id=cell.case["id"], agent=cell.agent, scenario=cell.case["scenario"])
    return CaseRecord(case=result, result=None, history=GOOD if verdict == "SUCCESS" else BAD, streets=NAMED)


def text_of(document: dict[str, Any]) -> str:
    return matrix_page(document, left).decode()


def test_nothing_in_it_points_outside() -> None:
    page = text_of(matrix())
    assert not re.findall(r'(?:src|href)="(?!#)', page)
    assert "http://" not in page.replace("http://www.w3.org", "")
    assert "@import" not in page
    assert "url(" not in page
    assert "default-src 'none'" in page


def test_every_sign_in_the_matrix_opens_a_card_that_is_there() -> None:
    page = text_of(matrix())
    links, names = re.findall(r'href="#([^"]+)"', page), re.findall(r'<article[^>]* id="([^"]+)"', page)
    assert len(names) == len(set(names)) == 45
    assert set(links) == set(names)


def test_ids_that_look_alike_have_cards_of_their_own() -> None:
    cases = [case(id_, "One", "pedestrian", {"basic": "SUCCESS"}) for id_ in ("one:a", "one-a", "one a")]
    names = re.findall(r'<article[^>]* id="([^"]+)"', text_of(matrix_of(cases, ["basic"])))
    assert len(set(names)) == 3


def test_a_case_that_left_nothing_says_why() -> None:
    document = matrix(["basic"])
    document["cases"][0]["results"]["basic"] = told("SIMULATOR_FAULT", "x", "basic", 1.0)
    assert "It left no folder." in text_of(document)


def test_words_of_others_are_text() -> None:
    hostile = "</title><script>alert(1)</script>"
    document = matrix([hostile])
    document["what"] = hostile
    document["cases"][0].update(title=hostile, place=hostile)
    document["cases"][0]["results"][hostile]["message"] = hostile
    assert text_of(document).count("<script>") == 1  # ours


def test_the_shares_stand_with_what_they_assume_and_a_bar_as_long_as_its_group_weighs() -> None:
    document = matrix()
    page = text_of(document)
    for assumption in document["shares"]["basic"]["assumptions"]:
        assert assumption in html.unescape(page)
    weights = [float(w) for w in re.findall(r'class="weight" style="width:([0-9.]+)%"', page)]
    costs = [group["burden"]["cost_musd"] for group in document["shares"]["basic"]["groups"] if group["burden"]]
    assert weights[::3] == pytest.approx([100.0 * cost / max(costs) for cost in costs], abs=0.001)


def test_a_sweep_has_its_map_and_sentences() -> None:
    page = text_of(sweep(40))
    assert "Where failing begins: FollowLeadingVehicle" in page
    assert 'class="success-map"' in page


def test_of_very_many_cases_those_have_cards_that_tell_most(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_CARDS", 40)
    document = sweep()
    verdicts = [cell.case["results"]["basic"]["verdict"] for cell in chosen(document)]
    assert len(verdicts) == 40
    assert verdicts.count("FAILURE") == 31
    assert "160 more cases of it were passed with more room" in text_of(document)


def test_a_page_that_grows_too_large_goes_on_without_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_BYTES", 100_000)
    page = text_of(matrix())
    pictured = re.findall(r'<article[^>]*data-verdict="(\w+)"[^>]*>(?:(?!</article>).)*case-picture', page, re.DOTALL)
    assert 5 <= len(pictured) <= 20
    assert set(pictured) == {"FAILURE"}  # which come first
    assert len(page) < 600_000


def test_a_hundred_cases_with_three_agents_stay_small() -> None:
    document = matrix(instances=20)
    assert len(document["cases"]) == 100
    assert len(matrix_page(document, left)) < 10_000_000


def test_it_is_written_from_the_folders_of_the_cases(tmp_path: Path) -> None:
    document = matrix_of(
        [case("dooring_1", "Dooring", "pedalcyclist", {"basic": "SUCCESS", "slow": "FAILURE"})], ["basic", "slow"]
    )
    folder = tmp_path / "basic" / "dooring_1"
    folder.mkdir(parents=True)
    write_json(folder / RESULT_FILE, {**case_result(id="dooring_1"), "schema_version": 2})
    write_history(folder, GOOD)
    write_streets(folder, NAMED)
    write_matrix_page(tmp_path, document)
    page = (tmp_path / PAGE_FILE).read_text(encoding="utf-8")
    assert page.count('class="case-picture"') == 1
    assert str(Path("slow", "dooring_1", RESULT_FILE)) in page  # which is not there: the card says so


def test_the_same_run_gives_the_same_bytes() -> None:
    assert matrix_page(matrix(), left) == matrix_page(matrix(), left)


def test_the_header_of_a_sample_shows_its_own_values_and_that_of_a_single_case_its_place() -> None:
    cases = [case(name, "One", "pedestrian", {"basic": "SUCCESS"}) for name in ("one_1#1", "one_1#2", "one_2")]
    shared = {"name": "kind", "value": "adult", "unit": "", "about": "who"}
    for each, ahead_m in zip(cases, (12.5, 31.0, 12.5), strict=True):
        values = [{"name": "ahead", "value": ahead_m, "unit": "m", "about": "where"}, shared]
        each.update(place="E 17th Ave" if each["id"].startswith("one_1") else "Bonham Ave", parameters=values)
    headers = re.findall(r"<summary><b>one_[^<]*</b>.*?<small>([^<]*)</small>", text_of(matrix_of(cases, ["basic"])))
    assert headers == ["ahead 12.5 m", "ahead 31 m", "Bonham Ave"]
