"""Claims about the passengers' verdict and the comfort score: what fails a ride, what merely costs."""

import json

import jsonschema
import pytest

from basu.errors import UserError
from basu.metrics.passengers.comfort_score import ComfortWeights, Harm, comfort_score
from basu.metrics.passengers.felt import balance, felt
from basu.metrics.passengers.metric import passengers_to_json
from basu.metrics.passengers.verdict import PassengerJudgement, judge
from basu.metrics.score import score
from basu.metrics.scoring import Scoring
from basu.output.report.documents import RESULT_SCHEMA, read_schema
from basu.records.history import History
from fakes.rides import braked, eastward, moving, ride

WALKING_MPS = 7.1 * 0.44704


def judged(history: History, weights: ComfortWeights | None = None) -> PassengerJudgement:
    found = judge(history, weights, ended_early=True)
    assert found is not None
    return found


def gentle() -> History:
    return ride(30.0, eastward(braked(5.0, 15.0, 0.8), 30.0))


def hard(**more: object) -> History:
    return ride(30.0, eastward(braked(WALKING_MPS, 5.0, 3.5), 30.0), **more)  # type: ignore[arg-type]


def test_a_gentle_ride_passes_with_full_comfort() -> None:
    found = judged(gentle())
    assert (found.passed, found.reasons, found.comfort) == (True, (), 1.0)


def test_the_incident_costs_nothing_in_the_thesis_and_everything_with_the_passengers() -> None:
    assert score(hard(), Scoring()).infraction == 1.0
    found = judged(hard())
    assert not found.passed
    assert found.reasons[0].startswith("phantom stop at 5.0 s from 3.17 m/s, up to 3.7")
    assert "pushed by more than 2.5 m/s²" in found.reasons[1]
    assert found.parts["balance"] == 0.0
    assert found.parts["harsh_stops"] == 0.4


def test_a_harsh_stop_for_an_actor_fails_as_well_and_costs_less() -> None:
    found = judged(hard(others=[(9, moving(26.0, 0.0, 0.0, 0.0))]))
    assert not found.passed
    assert found.reasons[0].startswith("harsh stop at 5.0 s")
    assert "vehicle.audi.tt (actor 9)" in found.reasons[0]
    assert found.parts["harsh_stops"] == 0.7


def test_a_near_miss_fails_a_ride() -> None:
    found = judged(ride(4.0, eastward(lambda _: 3.0, 5.0), others=[(9, moving(8.0 + 4.2 - 2.0, 0.0, 0.0, 0.0))]))
    assert [reason[:10] for reason in found.reasons] == ["near miss:"]
    assert found.parts["near_misses"] == 0.6


def test_having_to_step_now_and_then_costs_and_fails_no_actor() -> None:
    """1.2 m/s² for 1 s of 20.6 s on the move: half of the share at which nothing is left. A creep counts by its way."""

    def speed(t_s: float) -> float:
        return max(0.0, 5.0 - 1.2 * max(0.0, min(t_s - 5.0, 1.0)) - 0.5 * max(0.0, t_s - 14.0))

    history = ride(30.0, eastward(speed, 30.0))
    sensed = felt(history)
    assert sensed is not None
    upright = balance(sensed)
    assert upright.moving_s == pytest.approx(21.6 - 1.0, abs=0.11)
    assert upright.step_s == pytest.approx(1.0, abs=0.11)
    found = judged(history)
    assert found.passed
    assert found.parts["balance"] == pytest.approx(1.0 - upright.step_s / upright.moving_s / 0.1)


def test_weights_are_proportions_and_a_part_that_is_not_there_weighs_nothing() -> None:
    measured = {"balance": 0.0, "vibration": 1.0}
    weights = ComfortWeights(balance=1.0, vibration=3.0, service=100.0)
    assert comfort_score(measured, weights, Harm()) == pytest.approx(0.6 + 0.4 * 0.75)
    assert comfort_score(measured, ComfortWeights(balance=0.0, vibration=0.0), Harm()) is None


def test_passed_stops_are_no_breach_for_passengers_that_service_weighs_nothing() -> None:
    measured = {"balance": 1.0, "service": 0.0}
    assert comfort_score(measured, ComfortWeights(), Harm(stops_passed=1)) == pytest.approx(0.4 + 0.2 * 0.8)
    assert comfort_score(measured, ComfortWeights(service=0.0), Harm(stops_passed=1)) == 1.0


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"service": -1.0}, "the comfort weight of service is -1.0"),
        ({"service": float("nan")}, "the comfort weight of service is nan"),
        (dict.fromkeys(ComfortWeights().named(), 0.0), "all comfort weights are 0"),
    ],
)
def test_bad_weights_are_refused_in_a_sentence(given: dict[str, float], sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        ComfortWeights(**given)


@pytest.mark.parametrize("history", [gentle(), hard(others=[(9, moving(26.0, 0.0, 0.0, 0.0))])])
def test_the_document_is_as_the_schema_says(history: History) -> None:
    document = json.loads(json.dumps(passengers_to_json(history, judge(history)), allow_nan=False))
    schema = read_schema(RESULT_SCHEMA)
    jsonschema.Draft202012Validator({**schema["properties"]["passengers"], "$defs": schema["$defs"]}).validate(document)


def test_a_ride_of_a_moment_is_not_judged() -> None:
    assert judge(ride(0.1, eastward(lambda _: 1.0, 1.0))) is None
