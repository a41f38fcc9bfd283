"""Claims about verdicts: driving apart from faults, and the sentence that says why."""

from functools import partial

import pytest

from basu.outcome import Fault, Outcome, Status
from basu.scenarios.criteria import Arrives, Criterion, InTime, Judgement, KeepsLane, LeastDistance, NoCollision, Played
from basu.scenarios.exercise import Finding
from basu.scenarios.verdict import Verdict
from basu.scenarios.verdict import judge as judge_by
from fakes.drives import at, driven, hit, straight_route
from fakes.played import played


def met(_: Played) -> Finding:
    """The conflict came about."""
    return Finding(True, "the ego met child")


judge = partial(judge_by, exercised=met)
ENDED = Outcome(Status.SCENARIO_ENDED, "the scenario came to its end after 11.9 s")
ARRIVED = played(driven(at(10.0, 12.0), route=straight_route(100.0)), outcome=ENDED)
SHORT = played(driven(at(10.0, 4.0)), outcome=Outcome(Status.SCENARIO_TIMEOUT, "not over after 4 s"), timeout_s=4.0)
CRITERIA = (NoCollision(), Arrives(), InTime())


class Says(Criterion):
    """Whatever it was made to say."""

    def __init__(self, name: str, *, passed: bool | None, tick: int | None = None, deciding: bool = True) -> None:
        super().__init__(deciding=deciding)
        self.name, self.passed, self.tick = name, passed, tick

    def judge(self, played: Played) -> Judgement:
        return self.says(played, self.passed, f"because of {self.name}", tick=self.tick)


def test_the_message_of_a_case_says_that_a_person_drove() -> None:
    case = played(driven(at(10.0, 12.0), route=straight_route(100.0)), outcome=ENDED)
    case.history.frames["manual"][40:] = 1
    found = judge(CRITERIA, case, ENDED, triggered=True)
    assert found.verdict is Verdict.SUCCESS
    assert found.message.endswith("; driven by hand on a part of the way")


def test_meeting_every_criterion_is_success() -> None:
    found = judge(CRITERIA, ARRIVED, ENDED, triggered=True)
    assert (found.verdict, found.fault) == (Verdict.SUCCESS, Fault.NONE)
    assert found.message == "safe, completed and exercised: the ego met child"
    assert [one.criterion for one in found.judgements[3:]] == [
        "no near miss",
        "least distance",
        "least time to collision",
        "post-encroachment time",
    ]
    assert found.margins == {"distance_m": None, "ttc_s": None, "pet_s": None}


@pytest.mark.parametrize(
    ("status", "verdict", "fault"),
    [
        (Status.AGENT_CRASHED, Verdict.AGENT_FAULT, Fault.AGENT),
        (Status.AGENT_TIMED_OUT, Verdict.AGENT_FAULT, Fault.AGENT),
        (Status.AGENT_INVALID_CONTROL, Verdict.AGENT_FAULT, Fault.AGENT),
        (Status.SIMULATOR_FAILED, Verdict.SIMULATOR_FAULT, Fault.SIMULATOR),
        (Status.SETUP_FAILED, Verdict.SETUP_FAULT, Fault.SETUP),
        (Status.ENDED_FROM_OUTSIDE, Verdict.SETUP_FAULT, Fault.SETUP),
        (Status.BENCHMARK_FAILED, Verdict.BENCHMARK_FAULT, Fault.BENCHMARK),
        (Status.INTERRUPTED, Verdict.INTERRUPTED, Fault.USER),
    ],
)
@pytest.mark.parametrize("record", [ARRIVED, None])
def test_a_fault_is_the_verdict_whatever_was_driven(
    status: Status, verdict: Verdict, fault: Fault, record: Played | None
) -> None:
    found = judge(CRITERIA, record, Outcome(status, "it broke"), triggered=True)
    assert (found.verdict, found.fault, found.message) == (verdict, fault, "it broke")
    assert len(found.judgements) == (0 if record is None else 7)  # measured figures are reported all the same


@pytest.mark.parametrize("status", [Status.AGENT_CRASHED, Status.SIMULATOR_FAILED, Status.INTERRUPTED])
def test_an_unsafe_record_is_a_failure_whatever_fault_follows(status: Status) -> None:
    case = played(driven(at(10.0, 4.0), collisions=[hit(70)]))
    found = judge(CRITERIA, case, Outcome(status, "it broke"), triggered=True)
    assert found.verdict is Verdict.FAILURE
    assert found.message.startswith("no collision: hit static.poles at 3.50 s")
    assert found.message.endswith("; afterwards it broke")


def test_every_end_of_a_run_has_a_verdict() -> None:
    for status in Status:
        assert judge(CRITERIA, SHORT, Outcome(status, "over"), triggered=True).verdict in Verdict


def test_failing_names_the_criterion_and_its_evidence() -> None:
    found = judge((Arrives(),), SHORT, SHORT.outcome, triggered=True)
    assert found.verdict is Verdict.FAILURE
    assert found.message == "arrives: it got to 39.5 m of 200.0 m: not over after 4 s"


def test_a_collision_is_named_before_what_came_earlier() -> None:
    case = played(driven(at(10.0, 4.0), collisions=[hit(70)]))
    found = judge((Says("lane", passed=False, tick=10), NoCollision()), case, ENDED, triggered=True)
    assert found.message.startswith("no collision: hit static.poles at 3.50 s")


def test_of_other_failures_the_earliest_is_named_and_one_without_a_moment_last() -> None:
    said = (Says("a", passed=False), Says("b", passed=False, tick=30), Says("c", passed=False, tick=20))
    assert judge(said, ARRIVED, ENDED, triggered=True).message == "c: because of c"


def test_what_does_not_decide_fails_no_actor() -> None:
    found = judge((Arrives(), Says("told", passed=False, deciding=False)), ARRIVED, ENDED, triggered=True)
    assert found.verdict is Verdict.SUCCESS


def test_an_ego_that_arrives_without_having_triggered_it_met_no_scenario() -> None:
    found = judge(CRITERIA, ARRIVED, ENDED, triggered=False)
    assert (found.verdict, found.fault) == (Verdict.SETUP_FAULT, Fault.SETUP)
    assert found.message.startswith("it never triggered, although the ego arrived after 9.8 s")


def test_a_driver_that_never_comes_to_the_trigger_exercised_nothing() -> None:
    found = judge((NoCollision(),), SHORT, SHORT.outcome, triggered=False)
    assert (found.verdict, found.fault) == (Verdict.NOT_EXERCISED, Fault.NONE)
    assert found.message == "the ego never came to where the conflict begins"
    assert found.assessment is not None
    assert found.assessment.completed == Finding(False, "not over after 4 s")


def test_without_a_conflict_success_is_not_earned_and_failure_is_not_charged() -> None:
    absent = Finding(False, "no actor came")
    for case in (ARRIVED, SHORT):
        found = judge_by(CRITERIA, case, case.outcome, triggered=True, exercised=lambda _: absent)
        assert (found.verdict, found.message) == (Verdict.NOT_EXERCISED, "no actor came")
    unsafe = played(driven(at(10.0, 4.0), collisions=[hit(70)]))
    found = judge_by(CRITERIA, unsafe, ENDED, triggered=True, exercised=lambda _: absent)
    assert found.verdict is Verdict.FAILURE


def test_a_collision_on_the_way_to_the_trigger_is_why_it_was_not_reached() -> None:
    case = played(driven(at(10.0, 4.0), collisions=[hit(70)]), outcome=ENDED)
    assert judge(CRITERIA, case, ENDED, triggered=False).message.startswith("no collision: hit")


def test_the_end_of_the_time_fails_an_ego_that_met_all_else() -> None:
    found = judge((NoCollision(), KeepsLane()), SHORT, SHORT.outcome, triggered=True)
    assert (found.verdict, found.message) == (Verdict.FAILURE, "not over after 4 s")


def test_where_nothing_could_be_judged_no_actor_has_passed() -> None:
    found = judge((LeastDistance(0.5, to="child"),), ARRIVED, ENDED, triggered=True)
    assert found.verdict is Verdict.SETUP_FAULT
    assert found.message == "there is nothing to judge it by: child never was within 60 m of the ego"
    none = judge((), ARRIVED, ENDED, triggered=True)
    assert none.message == "there is nothing to judge it by: no criterion of it decides"


def test_a_run_that_ended_well_and_left_no_record_is_a_bug() -> None:
    assert judge(CRITERIA, None, ENDED, triggered=True).verdict is Verdict.BENCHMARK_FAULT


def test_only_what_the_agent_did_counts() -> None:
    assert [verdict.value for verdict in Verdict if verdict.counts] == ["SUCCESS", "FAILURE", "AGENT_FAULT"]
