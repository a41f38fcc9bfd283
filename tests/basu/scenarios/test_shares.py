"""Claims about shares: how cases become scenarios, scenarios groups, and groups a part of the toll."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from basu.scenarios.nhtsa import TOLLS, Group
from basu.scenarios.shares import ASSUMPTIONS, Result, results_from, sentence, standing, standing_to_json
from basu.scenarios.verdict import Verdict

OK, LOST, BROKE, SPOILT = Verdict.SUCCESS, Verdict.FAILURE, Verdict.AGENT_FAULT, Verdict.SIMULATOR_FAULT
VERDICTS = st.sampled_from([OK, LOST, BROKE, SPOILT, Verdict.SETUP_FAULT])


def result(group: Group, scenario: str, number: int, verdict: Verdict, distance_m: float | None = None) -> Result:
    """A case with a name of its own."""
    margins = {"distance_m": distance_m, "ttc_s": None, "pet_s": None}
    return Result(f"{scenario}_{number}", scenario, group, verdict, "so it was", margins)


def test_the_share_of_two_groups_is_weighed_by_their_cost() -> None:
    """Animal 6,231 survived, pedestrian 47,342 half survived."""
    found = standing(
        [
            result(Group.ANIMAL, "Deer", 1, OK),
            result(Group.PEDESTRIAN, "Crossing", 1, OK),
            result(Group.PEDESTRIAN, "Crossing", 2, LOST),
        ]
    )
    assert found.cost == pytest.approx((6_231 + 47_342 / 2) / (6_231 + 47_342))
    assert found.crashes == pytest.approx((297_968 + 70_461 / 2) / (297_968 + 70_461))
    assert found.fatal_crashes == pytest.approx((102 + 3_731 / 2) / (102 + 3_731))
    assert found.equivalent_lives == pytest.approx((681 + 5_176 / 2) / (681 + 5_176))
    assert found.measured_of_cost == pytest.approx((6_231 + 47_342) / 564_074)
    assert len(found.unmeasured) == 7


def test_a_scenario_with_many_places_weighs_no_more_than_one_with_few() -> None:
    many = [result(Group.ANIMAL, "Deer", number, OK) for number in range(9)]
    (share,) = standing([*many, result(Group.ANIMAL, "Dog", 1, LOST)]).groups
    assert (share.survived, share.scenarios, share.cases) == (pytest.approx(0.5), 2, 10)


def test_a_broken_agent_has_not_survived_and_a_broken_simulator_says_nothing() -> None:
    found = standing(
        [
            result(Group.ANIMAL, "Deer", 1, OK),
            result(Group.ANIMAL, "Deer", 2, BROKE),
            result(Group.ANIMAL, "Deer", 3, SPOILT),
            result(Group.REAR_END, "Leader", 1, SPOILT),
        ]
    )
    assert [share.survived for share in found.groups] == [0.5]
    assert [left.case for left in found.left_out] == ["Deer_3", "Leader_1"]
    assert Group.REAR_END in found.unmeasured


def test_the_shuttles_own_situations_are_told_and_weigh_nothing() -> None:
    found = standing([result(Group.SHUTTLE, "Phantom", 1, LOST), result(Group.ANIMAL, "Deer", 1, OK)])
    assert found.cost == 1.0
    assert [share.group for share in found.groups] == [Group.ANIMAL, Group.SHUTTLE]
    assert Group.SHUTTLE not in found.unmeasured


def test_without_a_group_of_the_typology_there_is_no_share() -> None:
    found = standing([result(Group.SHUTTLE, "Phantom", 1, OK)])
    assert found.cost is found.crashes is found.fatal_crashes is found.equivalent_lives is None
    assert sentence(found).startswith("no group of the typology was measured")
    assert standing([]).groups == ()


def test_how_narrowly_is_the_least_of_the_cases_that_were_survived() -> None:
    found = standing(
        [
            result(Group.ANIMAL, "Deer", 1, OK, 2.0),
            result(Group.ANIMAL, "Deer", 2, OK, 0.7),
            result(Group.ANIMAL, "Deer", 3, LOST, 0.0),
            result(Group.ANIMAL, "Deer", 4, OK),
        ]
    )
    (deer,) = found.narrowest
    assert (deer.least["distance_m"], deer.cases["distance_m"]) == (0.7, "Deer_2")
    assert (deer.least["ttc_s"], deer.cases["ttc_s"]) == (None, None)


@given(st.lists(st.tuples(st.sampled_from(list(Group)), st.sampled_from("abc"), VERDICTS), max_size=40))
def test_a_share_is_a_share_and_one_more_survived_never_lowers_it(cases: list[tuple[Group, str, Verdict]]) -> None:
    results = [result(group, f"{group.name}{name}", n, verdict) for n, (group, name, verdict) in enumerate(cases)]
    found = standing(results)
    assert found.cost is None or 0.0 <= found.cost <= 1.0
    measured = {share.group for share in found.groups if share.group in TOLLS}
    assert measured | set(found.unmeasured) == set(TOLLS)
    assert not measured & set(found.unmeasured)
    better = standing([one._replace(verdict=OK) if one.verdict is LOST else one for one in results])
    assert found.cost is None or (better.cost or 0.0) >= found.cost - 1e-12


def test_the_documents_of_cases_are_read_and_the_figures_written_with_their_assumptions() -> None:
    document = {
        "id": "deer_1",
        "scenario": "Deer",
        "group": "animal",
        "verdict": "SUCCESS",
        "message": "all 2 criteria were met",
        "margins": {"distance_m": 1.5, "ttc_s": None, "pet_s": None},
        "seed": 0,
    }
    written = json.loads(json.dumps(standing_to_json(standing(results_from([document])))))
    assert written["share_of_cost"] == 1.0
    assert written["groups"][0]["toll"]["cost_musd"] == 6_231
    assert written["assumptions"] == list(ASSUMPTIONS)
    assert written["narrowest"][0]["least"]["distance_m"] == 1.5
    assert written["sentence"] == (
        "it survives situations that stand for 100 % of the crash cost of the one group measured, which is 1 % of all; "
        "not measured: control loss, road departure, pedestrian, pedalcyclist, lane change, opposite direction, "
        "rear-end, crossing paths"
    )
