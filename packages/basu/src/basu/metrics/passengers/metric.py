"""The metric of the passengers: the key ``passengers`` of ``result.json``, its schema, events and lines."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from basu.metrics.display import NO, NOT_JUDGED, YES, Answer
from basu.metrics.json_schema import flag, integer, listing, mapping, number, record, record_of, text
from basu.metrics.passengers.causes import Cause
from basu.metrics.passengers.comfort_score import Harm, Vibration
from basu.metrics.passengers.felt import GRIP_MPS2, STEP_MPS2, Balance, PassengerPlace
from basu.metrics.passengers.harsh_stops import HarshStop
from basu.metrics.passengers.near_misses import NEAR_S, Party
from basu.metrics.passengers.service import EARLY_S, LATE_S, Visit
from basu.metrics.passengers.verdict import judge
from basu.metrics.registry import Column, Drive, Metric, register
from basu.outcome import Status

if TYPE_CHECKING:
    from basu.metrics.passengers.verdict import PassengerJudgement
    from basu.metrics.registry import JudgedRun
    from basu.records.history import History

CALM = frozenset({"not uncomfortable", "a little uncomfortable"})  # the mildest reactions of ISO 2631-1, annex C.2.3
_THRESHOLDS = record(
    step_mps2=number("m/s²", low=0),
    grip_mps2=number("m/s²", low=0),
    harsh_stop_mps2=number("m/s²", low=0),
    near_miss_s=number("s", low=0),
)
_LARGEST = record(
    about_="filtered, as felt at the place",
    braking_mps2=number("m/s²", low=0),
    speeding_up_mps2=number("m/s²", low=0),
    across_mps2=number("m/s²", low=0),
    jerk_along_mps3=number("m/s³", low=0),
    jerk_across_mps3=number("m/s³", low=0),
)
_WHERE = {"x_m": number("m"), "y_m": number("m"), "route_s_m": number("m")}
_CAUSE = record_of(Cause, {"away_m": number("m", null=True)})
_SECONDS = number("s", low=0, null=True)
_NEAR_MISS = record_of(
    Party,
    {"ttc_s": _SECONDS, "pet_s": _SECONDS, "tick": integer(low=0), "t_s": number("s", low=0), **_WHERE},
    signed=("ttc_tick", "pet_tick"),
)


@register
class Passengers(Metric):
    """The ride as its standing passengers would judge it."""

    name = "passengers"
    title = "passengers"
    order = 95
    schema = record(
        null_=True,
        about_="the ride as its standing passengers would judge it: docs/reference/passengers.md",
        passed=flag(),
        reasons=listing(text()),
        comfort_score=number(low=0, high=1, null=True),
        comfort_parts=mapping(number(low=0, high=1)),
        comfort_weights=mapping(number(low=0)),
        harm=record_of(Harm, {"completion": number(low=0, high=1)}, about="what goes before comfort"),
        place=record_of(
            PassengerPlace,
            about="where the passenger stands, from the vehicle's origin",
            signed=PassengerPlace._fields,
        ),
        thresholds=_THRESHOLDS,
        largest=_LARGEST,
        balance=record_of(Balance),
        vibration=record_of(Vibration, about="ISO 2631-1, weighted r.m.s."),
        harsh_stops=listing(
            record_of(HarshStop, {**_WHERE, "cause": _CAUSE}), "brakings felt above the threshold, with what was ahead"
        ),
        near_misses=listing(_NEAR_MISS, "actors that came close, by time to collision or post-encroachment time"),
        service=listing(record_of(Visit, signed=("delay_s", "headway_s")), "each stop against the timetable"),
    )

    def compute(self, drive: Drive) -> dict[str, Any] | None:
        """The verdict with every figure behind it; None for a ride too short to be judged."""
        scoring = drive.scoring
        judged = judge(
            drive.history,
            scoring.comfort_weights,
            scoring.standing_place,
            scoring.harsh_stop_mps2,
            tolerance_mps=scoring.speeding_tolerance_mps,
            ended_early=drive.outcome.status is Status.SCENARIO_ENDED,
        )
        return passengers_to_json(drive.history, judged)

    def events(self, value: Any) -> list[dict[str, Any]]:  # noqa: ANN401 - what `compute` returned
        """Harsh stops at their onset, and near misses."""
        if value is None:
            return []
        stops = [
            {
                **stop,
                "kind": "phantom_stop" if stop["cause"]["kind"] == "nothing" else "harsh_stop",
                "tick": stop["onset_tick"],
                "speed_mps": stop["from_mps"],
                "detail": f"from {stop['from_mps']:.2f} m/s, felt up to {stop['strongest_mps2']:.2f} m/s²: "
                f"{stop['cause']['detail']}",
            }
            for stop in value["harsh_stops"]
        ]
        misses = [
            {**party, "kind": "near_miss", "other": party["name"]}
            for party in value["near_misses"]
            if party["is_near_miss"]
        ]
        return [*stops, *misses]

    def lines(self, result: JudgedRun) -> list[str]:
        """The verdict with its reasons, and the figures behind the comfort score."""
        value = result.metrics[self.name]
        if value is None:
            return []
        comfort, largest = value["comfort_score"], value["largest"]
        score = "" if comfort is None else f", comfort score {comfort:.3f} (0 to 1, not in the driving score)"
        return [
            f"passengers        {'passed' if value['passed'] else 'failed'}{score}",
            *(f"                  {reason}" for reason in value["reasons"]),
            (
                f"                  up to {largest['braking_mps2']:.2f} m/s² braking, {largest['across_mps2']:.2f} "
                "across; standing passengers need a balancing step "
                f"{100.0 * value['balance']['step_share']:.1f} % of the time; "
                f"{' or '.join(value['vibration']['reactions'])}"
            ),
            *_boarding(value["service"]),
        ]

    def answers(self, result: JudgedRun) -> tuple[Answer, Answer]:
        """Return whether the drive was comfortable, and whether it was on time."""
        value = result.metrics[self.name]
        return _comfortable(value), _on_time(value)

    def columns(self, result: JudgedRun) -> list[Column]:
        """Return whether the passengers' verdict passed or failed, or a dash."""
        value = result.metrics[self.name]
        said = "\N{EN DASH}" if value is None else "passed" if value["passed"] else "failed"
        return [Column("passengers", said)]


def _comfortable(value: dict[str, Any] | None) -> Answer:
    """Answer by the harsh stops and the vibration that passengers feel while they stand."""
    if value is None or value["comfort_score"] is None:
        return Answer("comfortable", NOT_JUDGED, "the drive was too short or stood still")
    stops, reactions = value["harsh_stops"], value["vibration"]["reactions"]
    score = f"comfort score {value['comfort_score']:.2f} of 1"
    if stops:
        worst = max(stops, key=lambda stop: float(stop["strongest_mps2"]))
        often = "once" if len(stops) == 1 else f"{len(stops)} times"
        felt = f"felt up to {worst['strongest_mps2']:.1f} m/s² at {worst['t_s']:.1f} s"
        return Answer("comfortable", NO, f"braked harshly {often}, {felt}; {score}")
    if CALM.isdisjoint(reactions):
        return Answer("comfortable", NO, f"vibration is {' or '.join(reactions)}; {score}")
    return Answer("comfortable", YES, f"no harsh stop; {score}")


def _on_time(value: dict[str, Any] | None) -> Answer:
    """Answer by the timetable of the route."""
    visits = [] if value is None else value["service"]
    planned = [visit for visit in visits if visit["on_time"] is not None]
    if not planned:
        return Answer("on time", NOT_JUDGED, "the route has no timetable")
    kept = sum(visit["on_time"] for visit in planned)
    delays_s = [float(visit["delay_s"]) for visit in planned if visit["delay_s"] is not None]
    spread = [f"up to {-min(delays_s):.0f} s early"] if delays_s and min(delays_s) < -EARLY_S else []
    spread += [f"up to {max(delays_s):.0f} s late"] if delays_s and max(delays_s) > LATE_S else []
    spread += [f"{len(planned) - len(delays_s)} not reached"] if len(delays_s) < len(planned) else []
    reason = ", ".join([f"{kept} of {len(planned)} stops", *spread])
    return Answer("on time", YES if kept == len(planned) else NO, reason)


def _boarding(visits: list[dict[str, Any]]) -> list[str]:
    """How many passengers each stop had, where SUMO has brought any."""
    counted = [visit for visit in visits if visit.get("waiting") or visit.get("alighted")]
    return [
        f"  {visit['stop_id']:<16}{visit['boarded']} of {visit['waiting']} boarded, {visit['alighted']} alighted"
        for visit in counted
    ]


def passengers_to_json(history: History, judged: PassengerJudgement | None) -> dict[str, Any] | None:
    """The document; None for a ride too short to be judged."""
    if judged is None:
        return None
    sensed = judged.felt
    return {
        "passed": judged.passed,
        "reasons": list(judged.reasons),
        "comfort_score": judged.comfort,
        "comfort_parts": judged.parts,
        "comfort_weights": judged.weights.named(),
        "harm": judged.harm._asdict(),
        "place": judged.place._asdict(),
        "thresholds": {
            "step_mps2": STEP_MPS2,
            "grip_mps2": GRIP_MPS2,
            "harsh_stop_mps2": judged.harsh_mps2,
            "near_miss_s": NEAR_S,
        },
        "largest": {
            "braking_mps2": max(0.0, -float(sensed.filtered_along_mps2.min())),
            "speeding_up_mps2": max(0.0, float(sensed.filtered_along_mps2.max())),
            "across_mps2": float(abs(sensed.filtered_across_mps2).max()),
            "jerk_along_mps3": float(abs(sensed.jerk_along_mps3).max()),
            "jerk_across_mps3": float(abs(sensed.jerk_across_mps3).max()),
        },
        "balance": judged.balance._asdict(),
        "vibration": {**judged.vibration._asdict(), "reactions": list(judged.vibration.reactions)},
        "harsh_stops": [_stop(history, stop, why) for stop, why in judged.stops],
        "near_misses": [_party(history, party) for party in judged.parties],
        "service": [visit._asdict() for visit in judged.visits],
    }


def _stop(history: History, stop: HarshStop, why: Cause) -> dict[str, Any]:
    """One harsh stop with its evidence."""
    frame = history.frames[stop.onset_tick]
    return {
        **stop._asdict(),
        "x_m": float(frame["x_m"]),
        "y_m": float(frame["y_m"]),
        "route_s_m": float(frame["route_s_m"]),
        "cause": {**why._asdict(), "kind": why.kind.value, "away_m": _finite(why.away_m)},
    }


def _party(history: History, party: Party) -> dict[str, Any]:
    """An actor that came close, and where the vehicle was when it was closest."""
    tick = party.ttc_tick if party.ttc_s <= party.pet_s else party.pet_tick
    frame = history.frames[tick]
    return {
        **party._asdict(),
        "ttc_s": _finite(party.ttc_s),
        "pet_s": _finite(party.pet_s),
        "tick": tick,
        "t_s": float(frame["t_s"]),
        "x_m": float(frame["x_m"]),
        "y_m": float(frame["y_m"]),
        "route_s_m": float(frame["route_s_m"]),
    }


def _finite(value: float) -> float | None:
    """JSON knows no inf and no nan."""
    return value if math.isfinite(value) else None
