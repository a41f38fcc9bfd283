"""Claims about shares: how cases become scenarios, scenarios groups, and groups a part of the crash cost."""

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from basu.scenarios.nhtsa import BURDENS, Group
from basu.scenarios.share_documents import ASSUMPTIONS, results_from, sentence, shares_to_json
from basu.scenarios.shares import CountedCase, crash_shares
from basu.scenarios.verdict import Verdict

OK, LOST, BROKE, SPOILT = Verdict.SUCCESS, Verdict.FAILURE, Verdict.AGENT_FAULT, Verdict.SIMULATOR_FAULT
ABSENT = Verdict.NOT_EXERCISED
VERDICTS = st.sampled_from([OK, LOST, BROKE, ABSENT, SPOILT, Verdict.SETUP_FAULT])


def result(group: Group, scenario: str, number: int, verdict: Verdict, distance_m: float | None = None) -> CountedCase:
    """A case with a name of its own."""
    margins = {"distance_m": distance_m, "ttc_s": None, "pet_s": None}
    return CountedCase(f"{scenario}_{number}", scenario, group, verdict, "so it was", margins)


def test_the_share_of_two_groups_is_weighed_by_their_burden() -> None:
    """Animal 6,231 passed, pedestrian 47,342 half passed."""
    found = crash_shares(
        [
            result(Group.ANIMAL, "DeerAtDusk", 1, OK),
            result(Group.PEDESTRIAN, "PedestrianCrossing", 1, OK),
            result(Group.PEDESTRIAN, "PedestrianCrossing", 2, LOST),
        ]
    )
    assert found.cost is not None
    assert found.crashes is not None
    assert found.fatal_crashes is not None
    assert found.equivalent_lives is not None
    assert found.cost.share == pytest.approx((6_231 + 47_342 / 2) / (6_231 + 47_342))
    assert found.crashes.share == pytest.approx((297_968 + 70_461 / 2) / (297_968 + 70_461))
    assert found.fatal_crashes.share == pytest.approx((102 + 3_731 / 2) / (102 + 3_731))
    assert found.equivalent_lives.share == pytest.approx((681 + 5_176 / 2) / (681 + 5_176))
    assert found.measured_of_cost == pytest.approx((6_231 + 47_342) / 564_074)
    assert len(found.unmeasured) == 7


def test_scenarios_of_a_group_weigh_by_the_frequency_of_what_they_stand_for() -> None:
    """Lead vehicle stopped 975; decelerating 428, and the ego making a maneuver 85: the first alone is 66 % of them."""
    stopped, brakes = (Group.REAR_END, "StaticObject"), (Group.REAR_END, "LeadVehicleBrakes")
    (share,) = crash_shares([result(*stopped, 1, OK), result(*brakes, 1, LOST)]).groups
    assert share.passed is not None
    assert share.passed.share == pytest.approx(975 / (975 + 428 + 85))
    assert share.shown.share == pytest.approx(975 / 1_717)  # of all crashes of the group


def test_two_scenarios_that_stand_for_one_share_its_weight() -> None:
    cases = [
        result(Group.REAR_END, "StaticObject", 1, OK),
        result(Group.REAR_END, "LeadVehicleSwerves", 1, LOST),
        result(Group.REAR_END, "LeadVehicleBrakes", 1, LOST),
    ]
    (share,) = crash_shares(cases).groups
    assert share.passed is not None
    assert share.passed.share == pytest.approx(975 / 2 / (975 + 428 + 85))


def test_a_scenario_that_stands_for_none_weighs_as_the_mean_of_the_others() -> None:
    mine = [result(Group.ANIMAL, "MyCow", number, OK) for number in range(9)]
    (share,) = crash_shares([*mine, result(Group.ANIMAL, "DogOnTheRoad", 1, LOST)]).groups
    assert share.passed is not None
    assert (share.passed.share, share.scenarios, share.cases) == (pytest.approx(0.5), 2, 10)
    declared = [one._replace(pre_crash=(9,)) for one in mine]
    (share,) = crash_shares([*declared, result(Group.ANIMAL, "DogOnTheRoad", 1, LOST)]).groups
    assert share.passed is not None
    assert share.passed.share == pytest.approx(23 / 2 / 328)


def test_a_broken_agent_has_not_passed_and_a_broken_simulator_says_nothing() -> None:
    found = crash_shares(
        [
            result(Group.ANIMAL, "DeerAtDusk", 1, OK),
            result(Group.ANIMAL, "DeerAtDusk", 2, BROKE),
            result(Group.ANIMAL, "DeerAtDusk", 3, SPOILT),
            result(Group.REAR_END, "LeadVehicleBrakes", 1, SPOILT),
        ]
    )
    assert [share.passed and share.passed.share for share in found.groups] == [0.5]
    assert [left.case for left in found.left_out] == ["DeerAtDusk_3", "LeadVehicleBrakes_1"]
    assert Group.REAR_END in found.unmeasured


@pytest.mark.parametrize("spoilt", [SPOILT, ABSENT, Verdict.INTERRUPTED])
def test_no_fault_raises_what_is_shown(spoilt: Verdict) -> None:
    lost = [result(Group.ANIMAL, "DeerAtDusk", 1, OK), result(Group.ANIMAL, "DeerAtDusk", 2, LOST)]
    excused = [lost[0], lost[1]._replace(verdict=spoilt)]
    assert crash_shares(excused).shown_cost.share == pytest.approx(crash_shares(lost).shown_cost.share)
    assert (crash_shares(excused).judged, crash_shares(excused).cases) == (1, 2)


def test_absence_counts_for_neither_side_and_shows_nothing() -> None:
    present = [result(Group.ANIMAL, "DeerAtDusk", 1, OK), result(Group.ANIMAL, "DeerAtDusk", 2, LOST)]
    away = [one._replace(verdict=ABSENT) if one.verdict is LOST else one for one in present]
    met, missed = crash_shares(present), crash_shares(away)
    assert met.cost is not None
    assert missed.cost is not None
    assert (met.cost.share, missed.cost.share) == (pytest.approx(0.5), pytest.approx(1.0))
    assert missed.not_exercised == 1
    assert missed.shown_cost.share == pytest.approx(met.shown_cost.share)  # nothing gained
    nowhere = crash_shares([one._replace(verdict=ABSENT) for one in present])
    assert nowhere.cost is None
    assert nowhere.shown_cost.share == 0.0
    assert nowhere.groups[0].passed is None


def test_the_shuttles_own_situations_are_reported_and_weigh_nothing() -> None:
    found = crash_shares([result(Group.SHUTTLE, "Phantom", 1, LOST), result(Group.ANIMAL, "DeerAtDusk", 1, OK)])
    assert found.cost is not None
    assert found.cost.share == 1.0
    assert [share.group for share in found.groups] == [Group.ANIMAL, Group.SHUTTLE]
    assert Group.SHUTTLE not in found.unmeasured


def test_without_a_group_of_the_typology_there_is_no_share() -> None:
    found = crash_shares([result(Group.SHUTTLE, "Phantom", 1, OK)])
    assert found.cost is found.crashes is found.fatal_crashes is found.equivalent_lives is None
    assert sentence(found).startswith("1 of 1 cases judged: no group of the typology was exercised")
    assert crash_shares([]).groups == ()


def test_how_narrowly_is_the_least_of_the_cases_that_were_passed() -> None:
    found = crash_shares(
        [
            result(Group.ANIMAL, "DeerAtDusk", 1, OK, 2.0),
            result(Group.ANIMAL, "DeerAtDusk", 2, OK, 0.7),
            result(Group.ANIMAL, "DeerAtDusk", 3, LOST, 0.0),
            result(Group.ANIMAL, "DeerAtDusk", 4, OK),
        ]
    )
    (deer,) = found.narrowest
    assert (deer.least["distance_m"], deer.cases["distance_m"]) == (0.7, "DeerAtDusk_2")
    assert (deer.least["ttc_s"], deer.cases["ttc_s"]) == (None, None)


@pytest.mark.parametrize(
    ("passed", "cases", "low", "high"), [(8, 10, 0.4439, 0.9748), (0, 10, 0.0, 0.3085), (10, 10, 0.6915, 1.0)]
)
def test_the_interval_of_one_scenario_is_the_exact_one(passed: int, cases: int, low: float, high: float) -> None:
    """Figures of Clopper and Pearson, as tables of the binomial distribution have them."""
    found = crash_shares([result(Group.ANIMAL, "DeerAtDusk", n, OK if n < passed else LOST) for n in range(cases)]).cost
    assert found == pytest.approx((passed / cases, low, high), abs=1e-4)


def test_more_cases_narrow_the_interval() -> None:
    few, many = (
        crash_shares([result(Group.ANIMAL, "DeerAtDusk", n, OK if n % 2 else LOST) for n in range(count)]).cost
        for count in (4, 40)
    )
    assert few is not None
    assert many is not None
    assert many.high - many.low < few.high - few.low


@settings(deadline=None)
@given(st.lists(st.tuples(st.sampled_from(list(Group)), st.sampled_from("abc"), VERDICTS), max_size=40))
def test_a_share_lies_in_its_interval_and_one_more_passed_never_lowers_it(
    cases: list[tuple[Group, str, Verdict]],
) -> None:
    results = [result(group, f"{group.name}{name}", n, verdict) for n, (group, name, verdict) in enumerate(cases)]
    found = crash_shares(results)
    for estimate in (found.cost, found.shown_cost):
        assert estimate is None or 0.0 <= estimate.low <= estimate.share <= estimate.high <= 1.0
    measured = {share.group for share in found.groups if share.group in BURDENS and share.passed is not None}
    assert measured | set(found.unmeasured) == set(BURDENS)
    assert not measured & set(found.unmeasured)
    better = crash_shares([one._replace(verdict=OK) if one.verdict is LOST else one for one in results])
    assert found.cost is None or (better.cost is not None and better.cost.share >= found.cost.share - 1e-12)
    absent = crash_shares([one._replace(verdict=ABSENT) if one.verdict is LOST else one for one in results])
    assert absent.shown_cost.share <= found.shown_cost.share + 1e-12


def test_weights_that_sum_to_a_little_more_than_one_leave_a_share() -> None:
    names = ("CyclistAhead", "CyclistAtRightTurn", "CyclistCrossing", "CyclistSwerves", "Dooring", "DynamicObject")
    (share,) = crash_shares([result(Group.PEDALCYCLIST, name, 1, OK) for name in names]).groups
    assert share.passed is not None
    assert share.passed.share <= 1.0


def test_the_documents_of_cases_are_read_and_the_figures_written_with_their_assumptions() -> None:
    document = {
        "id": "deer_1",
        "scenario": "DeerAtDusk",
        "group": "animal",
        "verdict": "SUCCESS",
        "message": "safe, completed and exercised",
        "margins": {"distance_m": 1.5, "ttc_s": None, "pet_s": None},
        "collisions": [],
        "seed": 0,
    }
    struck = {**document, "id": "deer_2", "verdict": "FAILURE", "collisions": [{"at_fault": True}, {"at_fault": False}]}
    written = json.loads(json.dumps(shares_to_json(crash_shares(results_from([document, struck])))))
    assert written["share_of_cost"]["share"] == 0.5
    assert (written["collisions"], written["at_fault"]) == (2, 1)
    assert written["groups"][0]["burden"]["cost_musd"] == 6_231
    assert written["assumptions"] == list(ASSUMPTIONS)
    assert written["narrowest"][0]["least"]["distance_m"] == 1.5
    assert written["sentence"].startswith(
        "2 of 2 cases judged: it passes situations that stand for 50 % (1 to 99) of the crash cost of the one group "
        "exercised, which is 1 % of all, and shows 1 % (0 to 1) of all crash cost; not exercised: control loss"
    )
