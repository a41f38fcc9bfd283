"""Claims about risk for a mile: totals of table 1.1, rates that were put in, ranks of drivers, injury curves."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import norm

from basu.errors import ScenarioError
from basu.records.partners import Partner
from basu.scenarios.nhtsa import PRINTED_SUMS, TABLE_1_1, Group
from basu.scenarios.risk.estimate import KINDS, PlayedCase, Risk, risk
from basu.scenarios.risk.exposure import CONFLICTS, REPORTED, Counted, encounters, read_exposure
from basu.scenarios.risk.injuries import MPH_MPS, middle, severe
from basu.scenarios.shares import CountedCase
from basu.scenarios.verdict import Verdict

SCENARIO = {  # one of each group
    Group.CONTROL_LOSS: "ControlLoss",
    Group.ROAD_DEPARTURE: "CrossWind",
    Group.ANIMAL: "DogOnTheRoad",
    Group.PEDESTRIAN: "PedestrianCrossing",
    Group.PEDALCYCLIST: "CyclistCrossing",
    Group.LANE_CHANGE: "CutInBeforeStop",
    Group.OPPOSITE_DIRECTION: "StrayingOncoming",
    Group.REAR_END: "LeadVehicleBrakes",
    Group.CROSSING_PATHS: "StraightCrossingPaths",
}
PARTNER = {Group.PEDESTRIAN: Partner.WALKER, Group.PEDALCYCLIST: Partner.CYCLIST, Group.ANIMAL: Partner.ANIMAL}


def case(group: Group, *, hit: bool = False, verdict: Verdict | None = None, completed: bool = True) -> PlayedCase:
    """One case of a group, passed or with a collision at 6 m/s."""
    found = verdict or (Verdict.FAILURE if hit else Verdict.SUCCESS)
    counted = CountedCase(f"{SCENARIO[group]}_1", SCENARIO[group], group, found, "", {})
    return PlayedCase(counted, completed, PARTNER.get(group, Partner.VEHICLE), 6.0 if hit else None, 1.0)


def driven(crashes: Mapping[Group, int], trials: int) -> Risk:
    """The risk of a driver with so many crashes among the trials of each group."""
    return risk(case(group, hit=number < crashes[group]) for group in SCENARIO for number in range(trials))


def test_the_rates_of_the_groups_add_up_to_the_printed_total() -> None:
    assert sum(row.per_1e9_miles for row in TABLE_1_1.values()) == PRINTED_SUMS.per_1e9_miles


def test_each_rate_is_its_groups_crashes_over_one_number_of_miles() -> None:
    """2.7 * 10^12 miles a year in each row: a slip in a digit would show here."""
    for row in TABLE_1_1.values():
        assert row.crashes / row.per_1e9_miles == pytest.approx(2_706.0, rel=0.03)


def test_a_driver_with_the_conflicts_of_the_study_has_the_crashes_of_the_table() -> None:
    found = driven(dict.fromkeys(SCENARIO, REPORTED), CONFLICTS)
    assert found.rates["crashes"].value == pytest.approx(PRINTED_SUMS.per_1e9_miles / 1000.0)
    assert found.rates["crashes"].low < PRINTED_SUMS.per_1e9_miles / 1000.0 < found.rates["crashes"].high
    assert sum(group.reported for group in found.groups) == pytest.approx(PRINTED_SUMS.per_1e9_miles / 1000.0)


@pytest.mark.parametrize("rates", [(0.02, 0.1), (0.3, 0.6)])
def test_failure_rates_that_were_put_in_are_recovered_within_the_interval(rates: tuple[float, float]) -> None:
    """The chance of the trials is drawn 60 times; the interval, which also has the model's, holds the truth each time
    but for three at the most."""
    rng = np.random.default_rng(26)
    put_in = {group: float(rng.uniform(*rates)) for group in SCENARIO}
    truth = sum(encounters(group, {}) * rate for group, rate in put_in.items())
    held, narrow = 0, 0
    for _ in range(60):
        found = driven({group: int(rng.binomial(40, rate)) for group, rate in put_in.items()}, 40).rates["crashes"]
        held += found.low <= truth <= found.high
        narrow += found.high < 5.0 * truth
    assert held >= 57
    assert narrow == 60  # an interval that holds everything recovers nothing


def test_with_counted_conflicts_the_rates_are_recovered_and_a_wrong_rate_is_not() -> None:
    counted = {group: Counted(100_000, 1e6) for group in SCENARIO}
    rng = np.random.default_rng(7)
    held = 0
    for _ in range(60):
        cases = [case(group, hit=bool(rng.random() < 0.1)) for group in SCENARIO for _ in range(60)]
        found = risk(cases, counted).rates["crashes"]
        held += found.low <= 9 * 100_000 * 0.1 <= found.high
        assert not found.low <= 9 * 100_000 * 0.3 <= found.high
    assert held >= 54


def test_drives_with_importance_weights_recover_a_rare_rate_that_was_put_in() -> None:
    """A failure lies beyond a limit of a normal distribution, and most of the drives come from near that limit."""
    rng, drives, plain, truth = np.random.default_rng(11), 120, 0.1, 0.002
    counted = {group: Counted(100_000, 1e6) for group in SCENARIO}
    limit, held, narrow = norm.isf(truth), 0, 0
    for _ in range(60):
        at = rng.normal(np.where(rng.random(drives) < plain, 0.0, limit), 1.0)
        weights = 1.0 / (plain + (1.0 - plain) * np.exp(limit * at - limit**2 / 2.0))
        found = risk(
            (
                case(Group.PEDESTRIAN, hit=bool(place > limit))._replace(weight=float(weight), plain=plain)
                for place, weight in zip(at, weights, strict=True)
            ),
            counted,
        ).rates["crashes"]
        held += found.low <= 100_000 * truth <= found.high
        narrow += found.high < 2.5 * 100_000 * truth
    assert held >= 54
    assert narrow >= 54


def test_control_drivers_rank_as_they_must() -> None:
    careful = driven(dict.fromkeys(SCENARIO, 0), 10)
    blind = driven({group: 0 if group in (Group.CONTROL_LOSS, Group.ROAD_DEPARTURE) else 9 for group in SCENARIO}, 10)
    absent = [case(group, verdict=Verdict.NOT_EXERCISED, completed=False) for group in SCENARIO]
    standing = risk(absent * 10)
    creeper = risk([*absent * 8, *(case(group) for group in SCENARIO for _ in range(2))])
    assert careful.events == 0.0
    assert careful.rates["crashes"].high < blind.rates["crashes"].low
    assert careful.rates["disengagements"].high < creeper.rates["disengagements"].low
    assert standing.rates["crashes"].value == 0.0
    assert standing.events > creeper.events > careful.events
    assert standing.events > blind.events > careful.events


def test_a_case_without_its_conflict_widens_the_interval_and_gains_nothing() -> None:
    shown = risk(case(group) for group in SCENARIO for _ in range(10))
    evaded = risk(case(group, verdict=Verdict.NOT_EXERCISED) for group in SCENARIO for _ in range(10))
    assert evaded.rates["crashes"].value == 0.0
    assert evaded.rates["crashes"].high > 3.0 * shown.rates["crashes"].high


def test_each_estimate_is_in_its_interval_even_with_one_case_of_a_scenario() -> None:
    one = risk([case(group, hit=group is Group.ANIMAL) for group in SCENARIO])
    for rate in one.rates.values():
        assert rate.low <= rate.value <= rate.high
    assert one.rates["severe injuries on foot"].value == 0.0
    assert one.rates["severe injuries on foot"].high > 0.0


def test_a_fault_of_others_is_left_out_and_said() -> None:
    found = risk([case(Group.ANIMAL), case(Group.ANIMAL, verdict=Verdict.SIMULATOR_FAULT)])
    assert found.left_out == 1
    assert len(found.unmeasured) == 8


def test_the_curve_of_pedestrians_goes_through_its_published_points() -> None:
    for mph, share in ((16, 0.10), (23, 0.25), (31, 0.50), (39, 0.75), (46, 0.90)):
        assert severe(mph * MPH_MPS, Partner.WALKER, middle())[0] == pytest.approx(share, abs=0.016)


def test_an_occupant_is_hurt_less_than_a_person_on_foot_at_the_speeds_of_a_shuttle() -> None:
    for mps in (2.0, 6.7):
        assert severe(mps, Partner.VEHICLE, middle())[0] < severe(mps, Partner.CYCLIST, middle())[0]


def test_the_same_cases_have_the_same_risk_twice() -> None:
    assert driven(dict.fromkeys(SCENARIO, 2), 10) == driven(dict.fromkeys(SCENARIO, 2), 10)
    assert set(driven(dict.fromkeys(SCENARIO, 2), 10).rates) == set(KINDS)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[boats]\nevents = 1\nmiles = 2", "encounters of 'boats'; the groups are control loss"),
        ("[animal]\nevents = 1.5\nmiles = 2", "write events = a whole number"),
        ("[animal]\nevents = 1\nmiles = 0", "miles = a number above 0"),
        ("animal = 3", "write events"),
        ("[animal", "no TOML"),
    ],
)
def test_a_broken_file_of_encounters_gets_a_sentence(tmp_path: Path, text: str, said: str) -> None:
    file = tmp_path / "counted.toml"
    file.write_text(text)
    with pytest.raises(ScenarioError, match=said):
        read_exposure(file)
    with pytest.raises(ScenarioError, match="cannot be read"):
        read_exposure(tmp_path / "missing.toml")
