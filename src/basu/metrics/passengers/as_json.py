"""The passengers' part of a result as plain values: the key ``passengers`` of ``result.json``."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from basu.metrics.passengers.balance import GRIP_MPS2, STEP_MPS2
from basu.metrics.passengers.near_misses import NEAR_S

if TYPE_CHECKING:
    from basu.metrics.passengers.causes import Cause
    from basu.metrics.passengers.harsh_stops import HarshStop
    from basu.metrics.passengers.near_misses import Party
    from basu.metrics.passengers.verdict import Judged
    from basu.records.history import History


def passengers_to_json(history: History, judged: Judged | None) -> dict[str, Any] | None:
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
    """Somebody who came close, and where the vehicle was when it was closest."""
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
