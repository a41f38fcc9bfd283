"""The table of (EU) 2022/1426 for cut-ins, which names standing passengers, held against a recorded cut-in.

Annex III demands that a cut-in is avoided if the time to collision at the intrusion is above a value. The value depends
on the difference of the speeds, and on whether occupants may stand. The table is quoted from a summary of the text. The
place of the intrusion was not read: here it is that of UN Regulation 157, 0.3 m beyond the edge of the lane.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.careful_driver.model import Situation

if TYPE_CHECKING:
    from basu.metrics.careful_driver.encounters import OtherPath, VehicleEncounter
    from basu.metrics.careful_driver.model import Flags
    from basu.records.history import History

DIFFERENCES_KMH = (10.0, 20.0, 30.0, 40.0, 50.0, 60.0)
STANDING_S = (0.74, 1.32, 1.90, 2.47, 3.05, 3.63)  # standing or unfastened occupants
OTHERS_S = (0.48, 0.71, 0.94, 1.18, 1.41, 1.64)
STANDING_MPS2 = 2.4  # the braking from which the first row follows, within 0.01 s
INTRUSION_M = 0.3
KMH = 3.6


class Demand(NamedTuple):
    """What the table says of one cut-in."""

    ttc_s: float  # at the intrusion
    difference_kmh: float
    standing_s: float  # the table's values, straight between its columns
    others_s: float
    standing: bool  # whether the law demands that the cut-in is avoided
    others: bool
    sentence: str


class Intrusion(NamedTuple):
    """The moment of an intrusion into the planned lane."""

    tick: int
    ttc_s: float  # inf where the other is not slower
    difference_kmh: float
    gap_m: float  # between the bumpers, negative where the other is beside


def demand(history: History, encounter: VehicleEncounter, from_m: float, speed_mps: float) -> Demand | None:
    """What the table demands of a vehicle that is at ``from_m`` when the cut-in begins, and keeps ``speed_mps``.

    None for another situation, before the intrusion, and for differences of speed that the table does not have.
    """
    way = encounter.way
    if encounter.situation is not Situation.CUT_IN or way is None:
        return None
    seen = intrusion(history, way, encounter.begin_tick, from_m, speed_mps)
    if seen is None or not DIFFERENCES_KMH[0] <= seen.difference_kmh <= DIFFERENCES_KMH[-1]:
        return None
    return _found(max(0.0, seen.ttc_s), seen.difference_kmh)


def intrusion(history: History, way: OtherPath, begin_tick: int, from_m: float, speed_mps: float) -> Intrusion | None:
    """Return the moment in which another vehicle is `INTRUSION_M` within the planned lane; None where it never is.

    The own vehicle is at ``from_m`` along the route at ``begin_tick``, and keeps ``speed_mps`` from then on.
    """
    inside = np.flatnonzero((way.tick >= begin_tick) & is_inside(history, way))
    if len(inside) == 0:
        return None
    at = int(inside[0])
    later_s = float(way.tick[at] - begin_tick) * history.facts.step_s
    closing_mps = speed_mps - float(way.along_mps[at])
    gap_m = float(way.along_m[at]) - (from_m + speed_mps * later_s) - way.length_m
    ttc_s = gap_m / closing_mps if closing_mps > 0.0 else math.inf
    return Intrusion(int(way.tick[at]), ttc_s, closing_mps * KMH, gap_m)


def is_inside(history: History, way: OtherPath) -> Flags:
    """Return at which moments of a way the other is `INTRUSION_M` or more within the planned lane."""
    route, vehicle = history.facts.route, history.facts.vehicle
    half_lane_m = np.interp(way.along_m, route.s_m, route.lane_width_m) / 2.0
    half_m = way.width_m - vehicle.width_m / 2.0
    inside: Flags = np.abs(way.across_m) - half_m <= half_lane_m - INTRUSION_M
    return inside


def _found(ttc_s: float, difference_kmh: float) -> Demand:
    """Hold a time to collision against the table."""
    standing_s, others_s = (float(np.interp(difference_kmh, DIFFERENCES_KMH, row)) for row in (STANDING_S, OTHERS_S))
    standing, others = ttc_s > standing_s, ttc_s > others_s
    standing_has, others_have = ("has to" if each else "need not" for each in (standing, others))
    sentence = (
        f"annex III of (EU) 2022/1426: with {ttc_s:.2f} s at {difference_kmh:.0f} km/h a vehicle with standing "
        f"occupants {standing_has} avoid the contact (table: {standing_s:.2f} s), "
        f"another {others_have} (table: {others_s:.2f} s)"
    )
    return Demand(ttc_s, difference_kmh, standing_s, others_s, standing, others, sentence)
