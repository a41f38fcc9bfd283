"""Claims about the matrix on a console: what its cells say, how wide it is, that nothing is said by colour alone."""

import re

import pytest

from basu.output.report.scenarios.matrix_text import WIDTH, matrix_text
from fakes.scenario_documents import case, matrix, matrix_of, sweep, told


def line_of(text: str, name: str) -> str:
    return next(line for line in text.splitlines() if line.strip().startswith(name))


def test_a_cell_tells_how_many_were_passed_and_how_narrowly() -> None:
    cases = [
        case("occluded_child_1", "OccludedChild", "pedestrian", {"basic": "SUCCESS"}, distance_m=2.0),
        case("occluded_child_2", "OccludedChild", "pedestrian", {"basic": "SUCCESS"}, distance_m=0.83),
        case("occluded_child_3", "OccludedChild", "pedestrian", {"basic": "FAILURE"}),
    ]
    text = matrix_text(matrix_of(cases, ["basic"]))
    assert line_of(text, "OccludedChild").split()[1:] == ["2/3", "0.83", "m", "1.9", "s"]


def test_an_agents_fault_counts_as_not_passed_and_the_simulators_is_left_out() -> None:
    verdicts = ["SUCCESS", "AGENT_FAULT", "SIMULATOR_FAULT", "SETUP_FAULT"]
    cases = [case(f"dooring_{n}", "Dooring", "pedalcyclist", {"basic": verdict}) for n, verdict in enumerate(verdicts)]
    text = matrix_text(matrix_of(cases, ["basic"]))
    assert "1/2" in line_of(text, "Dooring")
    assert line_of(text, "Dooring").endswith("1! 2?")
    assert "! the agent itself broke down" in text
    assert "? not judged" in text


def test_where_nothing_was_judged_there_is_no_share() -> None:
    cases = [case("dooring_1", "Dooring", "pedalcyclist", {"basic": "INTERRUPTED"})]
    assert line_of(matrix_text(matrix_of(cases, ["basic"])), "Dooring").split()[1:] == ["-", "1?"]


@pytest.mark.parametrize("count", [1, 3, 5, 9])
def test_it_is_never_wider_than_a_console(count: int) -> None:
    agents = [f"an_agent_with_a_name_that_is_long_{number}" for number in range(count)]
    document = matrix(agents)
    document["cases"][0]["results"][agents[0]]["message"] = "word " * 100
    document["cases"][1]["scenario"] = "AScenarioWithANameThatIsLongerThanAnyColumn"
    lines = matrix_text(document).splitlines()
    assert max(len(line) for line in lines) <= WIDTH
    totals = [line for line in lines if line.startswith("all   ")]  # of tables below each other
    assert sum(line.count("/15") for line in totals) == count


def test_faults_are_reported_before_failures_and_many_failures_by_their_number() -> None:
    document = matrix(["forward"])
    document["cases"][-1]["results"]["forward"] = told("AGENT_FAULT", "x", "forward", 1.0)
    lines = matrix_text(document).splitlines()
    first = lines.index("forward did not pass 15:")
    assert lines[first + 1].startswith("  ! unexpected_stop_3")
    assert lines[first + 7] == "  and 9 more"


def test_colour_changes_no_character() -> None:
    document = matrix()
    plain = matrix_text(document)
    assert "\x1b" not in plain
    assert re.sub("\x1b\\[[0-9]+m", "", matrix_text(document, colour=True)) == plain


def test_what_the_shares_assume_stands_with_them() -> None:
    document = matrix()
    text = matrix_text(document)
    assert line_of(text, "crash cost").split()[2:] == [
        "81",
        "%",
        "(43-98)",
        "100",
        "%",
        "(65-100)",
        "0",
        "%",
        "(0-35)",
    ]
    assert "shown of all crash cost" in text
    for assumption in document["shares"]["basic"]["assumptions"]:
        assert " ".join(assumption.split()) in " ".join(text.split())


def test_one_group_alone_is_not_weighed() -> None:
    assert "crash cost" not in matrix_text(matrix_of([case("dooring_1", "D", "pedalcyclist", {"a": "SUCCESS"})], ["a"]))


def test_a_sweep_tells_where_failing_begins() -> None:
    assert "fails where gap < 2.89 m (31 of 58), passes elsewhere (142 of 142)" in matrix_text(sweep())


def test_control_drivers_stand_last_and_are_explained_and_without_them_is_said_how_to_play_them() -> None:
    document = matrix(agents=("blind", "basic"))
    text = matrix_text(document)
    assert line_of(text, "of the exercised").split()[-2:] == ["basic", "blind"]
    assert "control drivers: blind ignores all others." in text
    assert "--agent blind --agent creeper --agent standing" in matrix_text(matrix(agents=("basic",)))


def test_cases_that_were_not_exercised_have_a_sign_of_their_own_and_count_for_neither_side() -> None:
    verdicts = ["SUCCESS", "FAILURE", "NOT_EXERCISED", "NOT_EXERCISED"]
    cases = [case(f"deer_{n}", "DeerAtDusk", "animal", {"basic": verdict}) for n, verdict in enumerate(verdicts)]
    text = matrix_text(matrix_of(cases, ["basic"]))
    assert line_of(text, "DeerAtDusk").split()[1] == "1/2"
    assert "2○" in line_of(text, "DeerAtDusk")
    assert "○ not exercised: the conflict never came about" in text
    assert "?" not in line_of(text, "DeerAtDusk")
