"""Claims about the policy: safe, completed, exercised; a table of records, and what holds for all of them."""

from collections.abc import Callable
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from basu.outcome import Outcome, Status
from basu.scenarios.criteria import Arrives, InTime, NoCollision, Played
from basu.scenarios.policy import NoNearMiss
from basu.scenarios.verdict import Verdict, judge
from fakes.drives import hit, straight_route
from fakes.played import played
from fakes.rides import Row, braked, eastward, moving, ride

ENDED = Outcome(Status.SCENARIO_ENDED, "the scenario came to its end")
TIMEOUT = Outcome(Status.SCENARIO_TIMEOUT, "not over after 12 s")
CRITERIA = (NoCollision(), Arrives(), InTime())
ORDER = {Verdict.FAILURE: 0, Verdict.NOT_EXERCISED: 1, Verdict.SUCCESS: 2}


def drive(
    speed_mps: Callable[[float], float],
    other: Callable[[float], Row],
    *,
    length_m: float = 60.0,
    outcome: Outcome = ENDED,
    touches: bool = False,
) -> Played:
    """12 s east along a route of 60 m, with one actor."""
    history = ride(12.0, eastward(speed_mps, 13.0), others=[(9, other)], route=straight_route(length_m))
    collisions = (hit(100, "vehicle.audi.tt", 9),) if touches else ()
    return played(history, outcome=outcome, collisions=collisions)


def yields(t_s: float) -> float:
    """Brakes for the crossing at 40 m, waits before it and drives on."""
    return max(0.0, 8.0 - 2.0 * max(0.0, t_s - 2.0)) if t_s < 7.0 else min(8.0, 3.0 * (t_s - 7.0))


def crosses(meets_s: float) -> Callable[[float], Row]:
    """Across the road at 40 m."""
    return moving(40.0, 8.0 * meets_s, 0.0, -8.0)


TABLE = [
    ("yields and goes on", drive(yields, crosses(5.0)), Verdict.SUCCESS, (True, True, True)),
    ("touches", drive(yields, crosses(5.0), touches=True), Verdict.FAILURE, (False, True, True)),
    (
        "yields and never goes on",
        drive(braked(8.0, 2.0, 2.0), crosses(5.0), outcome=TIMEOUT),
        Verdict.FAILURE,
        (True, False, True),
    ),
    (
        "crawls far away",
        drive(lambda _: 2.0, crosses(5.0), outcome=TIMEOUT),
        Verdict.NOT_EXERCISED,
        (True, False, False),
    ),
    ("stands", drive(lambda _: 0.0, crosses(5.0), outcome=TIMEOUT), Verdict.NOT_EXERCISED, (True, False, False)),
    ("arrives long before", drive(lambda _: 8.0, crosses(11.0)), Verdict.NOT_EXERCISED, (True, True, False)),
    ("passes just in front", drive(lambda _: 8.0, crosses(6.3)), Verdict.FAILURE, (False, True, True)),
    (
        "passes a standing actor at 0.3 m",
        drive(lambda _: 8.0, moving(30.0, 2.2, 0.0, 0.0)),
        Verdict.FAILURE,
        (False, True, True),
    ),
    (
        "passes a standing actor at 0.5 m",
        drive(lambda _: 8.0, lambda _: {"x_m": 30.0, "y_m": 2.4}),
        Verdict.SUCCESS,
        (True, True, True),
    ),
]


@pytest.mark.parametrize(("case", "verdict", "answers"), [row[1:] for row in TABLE], ids=[row[0] for row in TABLE])
def test_table_of_drives(case: Played, verdict: Verdict, answers: tuple[bool, bool, bool]) -> None:
    found = judge(CRITERIA, case, case.outcome, triggered=True)
    assert found.assessment is not None
    assert tuple(finding.holds for finding in found.assessment) == answers
    assert found.verdict is verdict


def test_a_near_miss_fails_a_drive_that_met_every_criterion_of_its_scenario() -> None:
    """The case that used to survive: it passes at 0.30 m with a time to collision of 0.36 s."""
    oncoming = moving(76.0, 2.2, -8.0, 0.0)
    case = drive(lambda _: 8.0, oncoming)
    assert all(criterion.judge(case).passed for criterion in CRITERIA)
    found = judge(CRITERIA, case, ENDED, triggered=True)
    assert found.verdict is Verdict.FAILURE
    assert found.message.startswith("no near miss: child (vehicle.audi.tt) was 0.30 m away")


def test_an_ego_that_comes_near_a_standing_ego_has_done_so_alone() -> None:
    assert NoNearMiss().judge(drive(lambda _: 0.0, moving(60.0, 2.0, -8.0, 0.0))).passed is True


def test_a_comfortable_stop_behind_a_queue_is_no_near_miss() -> None:
    standing = lambda _: {"x_m": 41.0}  # noqa: E731
    case = drive(braked(8.0, 1.5, 1.5), standing, outcome=TIMEOUT)
    said = NoNearMiss().judge(case)
    assert said.passed is True, said.sentence


MOTIONS = st.builds(
    moving,
    st.floats(5.0, 60.0),
    st.floats(-40.0, 40.0),
    st.floats(-10.0, 10.0),
    st.floats(-10.0, 10.0),
)
SPEEDS = st.one_of(
    st.floats(0.0, 10.0).map(lambda mps: lambda _: mps),
    st.builds(braked, st.floats(1.0, 10.0), st.floats(0.0, 6.0), st.floats(0.5, 6.0)),
)
OUTCOMES = st.sampled_from([ENDED, TIMEOUT])


@settings(max_examples=30, deadline=None, derandomize=True)
@given(SPEEDS, MOTIONS, OUTCOMES, st.integers(0, 200), st.booleans())
def test_a_contact_never_improves_a_verdict_and_is_never_a_success(
    speed_mps: Callable[[float], float],
    other: Callable[[float], Row],
    outcome: Outcome,
    tick: int,
    triggered: bool,  # noqa: FBT001
) -> None:
    case = drive(speed_mps, other, outcome=outcome)
    before = judge(CRITERIA, case, outcome, triggered=triggered)
    touched = case._replace(history=replace(case.history, collisions=(hit(tick, "vehicle.audi.tt", 9),)))
    after = judge(CRITERIA, touched, outcome, triggered=triggered)
    assert after.verdict is not Verdict.SUCCESS
    if before.verdict in ORDER and after.verdict in ORDER:
        assert ORDER[after.verdict] == 0


@settings(max_examples=30, deadline=None, derandomize=True)
@given(MOTIONS, OUTCOMES, st.booleans())
def test_standing_is_never_a_success_and_without_a_contact_never_a_failure(
    other: Callable[[float], Row],
    outcome: Outcome,
    triggered: bool,  # noqa: FBT001
) -> None:
    found = judge(CRITERIA, drive(lambda _: 0.0, other, outcome=outcome), outcome, triggered=triggered)
    assert found.verdict is Verdict.NOT_EXERCISED
    assert found.assessment is not None
    assert found.assessment.completed.holds is False


CREEPING_MPS, AT_2_CM = 0.4, 1.27  # the ego's speed; beside its middle: half widths of 1 m and 0.25 m, and 2 cm


@pytest.mark.parametrize(
    ("kind", "their_mps", "speed_mps", "near"),
    [
        pytest.param("walker.pedestrian.0010", 0.0, CREEPING_MPS, True, id="a child that stands"),
        pytest.param("walker.pedestrian.0010", 0.8, CREEPING_MPS, True, id="a child that walks"),
        pytest.param("vehicle.diamondback.century", 0.0, CREEPING_MPS, True, id="a cyclist that stands"),
        pytest.param("vehicle.audi.tt", 0.8, CREEPING_MPS, True, id="a car that drives"),
        pytest.param("vehicle.audi.tt", 0.0, CREEPING_MPS, False, id="a car that stands"),
        pytest.param("vehicle.audi.tt", 0.0, 0.6, True, id="a car that stands, passed faster"),
        pytest.param("walker.pedestrian.0010", 0.8, 0.0, False, id="a child that walks by an ego at rest"),
    ],
)
def test_near_misses_count_by_the_speed_and_kind_of_the_other(
    kind: str, their_mps: float, speed_mps: float, *, near: bool
) -> None:
    other = moving(1.0 if their_mps == 0.0 else 5.0, AT_2_CM, -their_mps, 0.0)
    history = ride(6.0, eastward(lambda _: speed_mps, 7.0), others=[(9, other)], sizes={9: (0.25, 0.25)})
    history = replace(history, facts=replace(history.facts, actor_types={9: kind}))
    assert NoNearMiss().judge(played(history)).passed is not near
