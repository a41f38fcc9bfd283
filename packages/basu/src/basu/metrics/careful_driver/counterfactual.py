"""What each model would have done in a recorded encounter: its vehicle in the place of the one under test.

From the beginning of the encounter until the contact the other moves as recorded. The contact changed its way, so from
then on it goes on with its speed, its braking and its lateral speed. The model begins at the recorded place with the
recorded speed, but not above the limit. Behind a vehicle that it follows it begins with at least the gap that it keeps
itself. So neither speeding nor a short gap of the vehicle under test makes an encounter look unavoidable.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.careful_driver.encounters import own_middle_m, way_of
from basu.metrics.careful_driver.model import Situation
from basu.metrics.careful_driver.simulation import RelativeMotion, Sizes, drive
from basu.metrics.speeding import limits_mps

if TYPE_CHECKING:
    from basu.metrics.careful_driver.encounters import OtherPath, VehicleEncounter
    from basu.metrics.careful_driver.model import CarefulDriver, Numbers
    from basu.records.history import History

ON_S = 10.0  # the models drive on for so long after the contact
TREND_S = 0.5  # over which the other's braking and lateral speed before the contact are taken


class ModelOutcome(NamedTuple):
    """The outcome of an encounter if one model of a careful driver had driven."""

    model: str
    avoids: bool
    from_mps: float
    reaction_s: float  # after the encounter began; nan where it saw no danger
    hardest_mps2: float
    impact_mps: float  # 0 where it avoids the contact
    least_gap_m: float  # to the other in the lane, inf where there was none
    sentence: str


def start(history: History, encounter: VehicleEncounter) -> tuple[float, float]:
    """Return the place along the route and the speed with which a careful driver begins: not above the limit."""
    begin = encounter.begin_tick
    speed_mps = min(float(history.speed_mps()[begin]), float(limits_mps(history)[begin]))
    return own_middle_m(history, begin), speed_mps


def answers(
    history: History, encounter: VehicleEncounter, models: tuple[CarefulDriver, ...]
) -> tuple[ModelOutcome, ...]:
    """The answer of each model; none for an encounter that is none of the situations."""
    if encounter.situation is None or encounter.way is None:
        return ()
    return tuple(_answer(history, encounter, encounter.way, encounter.situation, model) for model in models)


def _answer(
    history: History, encounter: VehicleEncounter, way: OtherPath, situation: Situation, model: CarefulDriver
) -> ModelOutcome:
    """Let one model drive."""
    begin, step_s = encounter.begin_tick, history.facts.step_s
    start_m, speed_mps = start(history, encounter)
    if encounter.ahead is not None:
        at = int(np.clip(begin - encounter.ahead.tick[0], 0, len(encounter.ahead.tick) - 1))
        keeps_m = float(model.following_m(np.array([speed_mps]))[0]) + encounter.ahead.length_m
        start_m = min(start_m, float(encounter.ahead.along_m[at]) - keeps_m)
    driven = drive(
        model,
        np.array([start_m]),
        np.array([speed_mps]),
        _motion(history, encounter, way),
        Sizes(way.length_m, way.width_m),
        situation,
        step_s,
    )
    reaction = float(driven.reaction_step[0])
    answer = ModelOutcome(
        model=model.name,
        avoids=not bool(driven.contact[0]),
        from_mps=speed_mps,
        reaction_s=reaction * step_s if reaction >= 0.0 else float("nan"),
        hardest_mps2=float(driven.hardest_mps2[0]),
        impact_mps=float(driven.impact_mps[0]),
        least_gap_m=float(driven.least_gap_m[0]),
        sentence="",
    )
    return answer._replace(sentence=_words(answer))


def _words(answer: ModelOutcome) -> str:
    """Return an answer as a sentence."""
    if np.isnan(answer.reaction_s):
        did = "sees no danger"
    else:
        did = f"reacts after {answer.reaction_s:.2f} s and brakes with up to {answer.hardest_mps2:.1f} m/s²"
    came = "avoids the contact" if answer.avoids else f"hits the other with a difference of {answer.impact_mps:.1f} m/s"
    return f"{answer.model} begins at {answer.from_mps:.1f} m/s, {did}, and {came}"


def _motion(history: History, encounter: VehicleEncounter, way: OtherPath) -> RelativeMotion:
    """Return the other's way from the beginning of the encounter on, recorded and then continued."""
    step_s, first = history.facts.step_s, encounter.begin_tick - int(way.tick[0])
    recorded = way.part(first, len(way.tick)) if first >= 0 else way
    if not encounter.is_contact:
        recorded = _with_rest(history, encounter, recorded)
    trend = max(1, min(round(TREND_S / step_s), len(way.tick) - 1))
    last_mps = max(0.0, float(recorded.along_mps[-1]))
    braking_mps2 = max(0.0, float(way.along_mps[-1 - trend] - way.along_mps[-1]) / (trend * step_s))
    sideways_mps = float(recorded.across_m[-1] - recorded.across_m[-min(trend, len(recorded.tick) - 1) - 1]) / max(
        step_s, min(trend, len(recorded.tick) - 1) * step_s
    )
    count = round(ON_S / step_s)
    later_mps = np.maximum(last_mps - braking_mps2 * step_s * np.arange(1, count + 1), 0.0)
    along_m = np.concatenate([recorded.along_m, recorded.along_m[-1] + np.cumsum(later_mps) * step_s])
    across_m = np.concatenate(
        [recorded.across_m, _continued(float(recorded.across_m[-1]), sideways_mps, step_s, count)]
    )
    along_mps = np.concatenate([np.maximum(recorded.along_mps, 0.0), later_mps])
    across_mps = np.gradient(across_m, step_s)
    return RelativeMotion(along_m[:, None], across_m[:, None], along_mps[:, None], across_mps[:, None])


def _with_rest(history: History, encounter: VehicleEncounter, way: OtherPath) -> OtherPath:
    """Return a way with what the record has of it after a near miss, for up to `ON_S`."""
    key = int(encounter.other.rpartition("actor ")[2].rstrip(")"))
    last = min(len(history.frames) - 1, encounter.tick + round(ON_S / history.facts.step_s) // 2)
    for tick in range(last, encounter.tick, -1):
        rest = way_of(history, key, tick)
        if rest is not None and rest.tick[0] <= way.tick[0]:
            return rest.part(int(way.tick[0] - rest.tick[0]), len(rest.tick))
    return way


def _continued(last_m: float, sideways_mps: float, step_s: float, count: int) -> Numbers:
    """Return lateral places that go on towards the middle of the lane, and stay in it."""
    if last_m * sideways_mps >= 0.0:
        return np.full(count, last_m)
    moved_m = last_m + sideways_mps * step_s * np.arange(1, count + 1)
    return np.where(np.sign(moved_m) == np.sign(last_m), moved_m, 0.0)
