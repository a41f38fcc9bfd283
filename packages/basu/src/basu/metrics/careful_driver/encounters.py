"""Recorded encounters with other vehicles as UN Regulation 157 describes them: cut-in, cut-out, deceleration.

The other's way is taken along and across the planned route. So the vehicle under test cannot bring an encounter about
by leaving its lane. Other encounters are named, and the models say nothing of them.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.boxes import UNKNOWN_M
from basu.metrics.careful_driver.model import Situation
from basu.metrics.collisions import beginnings
from basu.metrics.passengers.near_misses import near_misses
from basu.records.partners import BICYCLES

if TYPE_CHECKING:
    from basu.metrics.careful_driver.model import Numbers
    from basu.records.history import History
    from basu.records.structured import StructuredArray

LOOK_BACK_S = 10.0  # how long before the contact an encounter may begin
SETTLED_S = 4.0  # so long after a cut-in a driver has restored its distance: what follows is another situation
SAME_WAY_RAD = math.radians(30.0)  # between the other's course and the route; as for crossings of near misses
AGAINST_RAD = math.radians(150.0)
SIDEWAYS_MPS = 0.1  # below this a vehicle keeps its lane
WANDERING_M = 0.375  # UN Regulation 157: a vehicle moves so far about the middle of its lane without leaving it
BRAKES_MPS2 = 1.0  # a mean deceleration over `OVER_S` above this is a braking
OVER_S = 0.5
SLOWED_MPS = 1.0  # a braking takes at least this
BEHIND_M, AHEAD_M = 40.0, 120.0  # of the vehicle under test, where the route is looked at
STOOD_MPS = 0.5
BESIDE_M = (
    0.3  # a vehicle within this of the strip is about to come into it: two boxes may touch before it is seen there
)


class OtherPath(NamedTuple):
    """Another vehicle's way beside the planned route, (K,) each; the ticks are without a gap."""

    tick: Numbers
    along_m: Numbers
    across_m: Numbers  # from the middle of the planned lane, positive to the right
    along_mps: Numbers
    turned_rad: Numbers  # between its course and the route
    length_m: float  # half the sums of both vehicles' lengths and widths
    width_m: float

    @property
    def clear_m(self) -> Numbers:
        """Lateral distance of its side from the strip that the vehicle under test sweeps in its lane."""
        return np.abs(self.across_m) - self.width_m

    def part(self, first: int, end: int) -> OtherPath:
        """Return some of its moments."""
        return self._replace(**{name: getattr(self, name)[first:end] for name in self._fields[:5]})


class VehicleEncounter(NamedTuple):
    """A contact or near miss with another vehicle."""

    tick: int
    other: str  # blueprint id and actor id
    is_contact: bool
    situation: Situation | None  # None where it is none of the three
    sentence: str  # what happened, or why the models say nothing
    begin_tick: int  # the first from which a careful driver could have seen it coming; -1 without a situation
    way: OtherPath | None  # the other's, up to the contact
    ahead: OtherPath | None  # of the vehicle that the own one followed at the beginning; None for a cut-in


def encounters(history: History) -> tuple[VehicleEncounter, ...]:
    """All contacts with actors, and near misses, in order of time."""
    found = [(event.tick, event.other_id, True) for event in beginnings(history, {}) if event.other_id != 0]
    for party in near_misses(history):
        if party.is_near_miss:
            key = int(party.name.rpartition("actor ")[2].rstrip(")"))
            found.append((max(party.ttc_tick, party.pet_tick) if party.ttc_tick < 0 else party.ttc_tick, key, False))
    return tuple(_encounter(history, *one) for one in sorted(found))


def _encounter(history: History, tick: int, key: int, is_contact: bool) -> VehicleEncounter:  # noqa: FBT001 - unpacked
    """One contact or near miss with its situation."""
    kind = history.facts.actor_types.get(key, "an unknown type")
    bare = VehicleEncounter(tick, f"{kind} (actor {key})", is_contact, None, "", -1, None, None)
    if not kind.startswith("vehicle.") or kind in BICYCLES:
        what = "pedestrian" if kind.startswith("walker.") else "cyclist" if kind in BICYCLES else "thing"
        return bare._replace(sentence=f"no model: the other is a {what}, and the models know motor vehicles only")
    last = max(0, tick - 1) if is_contact else tick
    way = way_of(history, key, last)
    if way is None:
        return bare._replace(sentence="no model: the record does not hold the other's way")
    why_not = _unfit(history, way, last)
    if why_not:
        return bare._replace(sentence=f"no model: {why_not}")
    return _with_situation(history, bare, way, key)


def way_of(history: History, key: int, last: int) -> OtherPath | None:
    """Return the way of an actor up to the tick ``last``, over `LOOK_BACK_S`; None where it was not there before."""
    return way_between(history, key, max(0, last - round(LOOK_BACK_S / history.facts.step_s)), last)


def way_between(history: History, key: int, first: int, last: int) -> OtherPath | None:
    """Return the way of an actor from one tick to another, or its last part without a gap; None where it left."""
    rows = history.others[history.others["id"] == key]
    rows = rows[(rows["tick"] >= first) & (rows["tick"] <= last)]
    if len(rows) == 0 or int(rows["tick"][-1]) < last - 1:
        return None
    gaps = np.flatnonzero(np.diff(rows["tick"]) > 1)
    return _beside_route(history, rows[int(gaps[-1]) + 1 if len(gaps) else 0 :], key)


def _beside_route(history: History, rows: StructuredArray, key: int) -> OtherPath | None:
    """Return rows of one actor as a way beside the route, which is taken near the vehicle under test."""
    route = history.facts.route
    at_m = history.frames["route_s_m"][rows["tick"]]
    near = (route.s_m >= at_m.min() - BEHIND_M) & (route.s_m <= at_m.max() + AHEAD_M)
    if np.count_nonzero(near) < 2 or len(rows) < 2:
        return None
    points_m, s_m = route.points_m[near, :2], route.s_m[near]
    along = np.diff(points_m, axis=0)
    length_m = np.hypot(*along.T)
    unit = along / length_m[:, None]
    away_m = np.column_stack([rows["x_m"], rows["y_m"]])[:, None, :] - points_m[None, :-1, :]
    forward_m = np.einsum("ksd,sd->ks", away_m, unit)
    right_m = away_m[:, :, 1] * unit[None, :, 0] - away_m[:, :, 0] * unit[None, :, 1]
    beyond_m = forward_m - np.clip(forward_m, 0.0, length_m[None, :])
    nearest = np.argmin(beyond_m**2 + right_m**2, axis=1)
    picked = np.arange(len(rows)), nearest
    velocity_mps = np.column_stack([rows["velocity_x_mps"], rows["velocity_y_mps"]])
    along_mps = np.einsum("kd,kd->k", velocity_mps, unit[nearest])
    course_rad = np.where(
        np.hypot(*velocity_mps.T) > STOOD_MPS, np.arctan2(velocity_mps[:, 1], velocity_mps[:, 0]), rows["yaw_rad"]
    )
    turned_rad = course_rad - np.arctan2(unit[nearest, 1], unit[nearest, 0])
    half_m = history.facts.actor_sizes.get(key, UNKNOWN_M)
    vehicle = history.facts.vehicle
    return OtherPath(
        tick=rows["tick"].astype(np.int64),
        along_m=s_m[:-1][nearest] + forward_m[picked],
        across_m=right_m[picked],
        along_mps=along_mps,
        turned_rad=np.abs(np.arctan2(np.sin(turned_rad), np.cos(turned_rad))),
        length_m=half_m[0] + (vehicle.front_m + vehicle.rear_m) / 2.0,
        width_m=half_m[1] + vehicle.width_m / 2.0,
    )


def own_middle_m(history: History, tick: int) -> float:
    """Return the place of the middle of the vehicle under test along the route."""
    vehicle = history.facts.vehicle
    return float(history.frames["route_s_m"][tick]) + (vehicle.front_m - vehicle.rear_m) / 2.0


def _unfit(history: History, way: OtherPath, last: int) -> str:
    """Return why an encounter is none of the situations at all; empty where it may be one."""
    if way.turned_rad[-1] >= AGAINST_RAD:
        return "the other came towards the vehicle, and the models know traffic in one direction"
    if way.turned_rad[-1] > SAME_WAY_RAD:
        return "the ways of both crossed, and the models know traffic in one direction"
    if way.along_m[-1] < own_middle_m(history, last):
        return "the other came from behind or beside, and the models brake for what is ahead"
    if way.clear_m[-1] > BESIDE_M:
        beside_m = float(history.frames["lateral_m"][last])
        return (
            f"the other was beside the planned lane, and the vehicle was {abs(beside_m):.1f} m off its middle; "
            "the models keep their lane"
        )
    return ""


def _with_situation(history: History, bare: VehicleEncounter, way: OtherPath, key: int) -> VehicleEncounter:
    """Return an encounter with a vehicle ahead in the lane, with its situation if it is one of the three."""
    step_s = history.facts.step_s
    outside = np.flatnonzero(way.clear_m > 0.0)
    entry = min(int(outside[-1]) + 1, len(way.tick) - 1) if len(outside) else None
    braked = _braking_begins(way, step_s)
    if entry is not None and not (braked is not None and (braked - entry) * step_s > SETTLED_S):
        begin = sideways_begins(way, entry, step_s)
        sentence = f"cut-in: the other came into the lane at {_time_s(history, way, entry):.1f} s"
        return _checked(history, bare, Situation.CUT_IN, sentence, way, begin, None)
    uncovered = _uncovered(history, way, key)
    if uncovered is not None:
        leader, begin = uncovered
        sentence = f"cut-out: the vehicle before the other left the lane at {_time_s(history, leader, begin):.1f} s"
        return _checked(history, bare, Situation.CUT_OUT, sentence, way, _index_of(way, leader, begin), leader)
    if braked is not None:
        sentence = f"deceleration: the vehicle ahead began to brake at {_time_s(history, way, braked):.1f} s"
        return _checked(history, bare, Situation.DECELERATION, sentence, way, braked, way)
    seen_s = len(way.tick) * step_s
    words = f"no model: the other was ahead in the lane for {seen_s:.1f} s and did not brake; nothing was sudden"
    return bare._replace(sentence=words)


def _checked(
    history: History,
    bare: VehicleEncounter,
    situation: Situation,
    sentence: str,
    way: OtherPath,
    begin: int,
    leader: OtherPath | None,
) -> VehicleEncounter:
    """Return an encounter with its situation, unless the vehicle under test stood when it began."""
    tick = int(way.tick[begin])
    if float(history.speed_mps()[tick]) < STOOD_MPS:
        words = f"no model: {sentence}, and the vehicle stood when it began, so it has no speed to keep"
        return bare._replace(sentence=words)
    return bare._replace(situation=situation, sentence=sentence, begin_tick=tick, way=way, ahead=leader)


def _time_s(history: History, way: OtherPath, index: int) -> float:
    return float(history.frames["t_s"][int(way.tick[index])])


def _index_of(way: OtherPath, leader: OtherPath, index: int) -> int:
    """Return the place in one way of a moment of another."""
    return int(np.clip(leader.tick[index] - way.tick[0], 0, len(way.tick) - 1))


def sideways_begins(way: OtherPath, entry: int, step_s: float) -> int:
    """Return the moment from which the other moved towards the lane until its entry."""
    towards_mps = -np.gradient(np.abs(way.across_m), step_s)
    calm = np.flatnonzero(towards_mps[:entry] <= SIDEWAYS_MPS)
    return int(calm[-1]) if len(calm) else 0


def _braking_begins(way: OtherPath, step_s: float) -> int | None:
    """Return the moment before the other's last braking; None where it did not brake."""
    over = max(1, round(OVER_S / step_s))
    if len(way.tick) <= over:
        return None
    slowing_mps2 = (way.along_mps[:-over] - way.along_mps[over:]) / (over * step_s)
    brakes = np.flatnonzero(slowing_mps2 > BRAKES_MPS2)
    if len(brakes) == 0:
        return None
    calm = np.flatnonzero(slowing_mps2[: brakes[-1]] <= BRAKES_MPS2)
    begin = int(calm[-1]) + 1 if len(calm) else 0
    lost_mps = float(way.along_mps[begin] - way.along_mps[begin:].min())
    return begin if lost_mps >= SLOWED_MPS else None


def _uncovered(history: History, way: OtherPath, key: int) -> tuple[OtherPath, int] | None:
    """Return the vehicle that drove between both and left the lane, with the moment; None where none did."""
    for rival in sorted({int(each) for each in np.unique(history.others["id"])} - {key}):
        if not history.facts.actor_types.get(rival, "").startswith("vehicle."):
            continue
        leader = way_of(history, rival, int(way.tick[-1]))
        if leader is None or leader.clear_m[-1] <= 0.0:
            continue
        inside = np.flatnonzero(leader.clear_m <= 0.0)
        if len(inside) == 0:
            continue
        left, at = int(inside[-1]), _index_of(way, leader, int(inside[-1]))
        own_m = own_middle_m(history, int(leader.tick[left]))
        if not own_m < leader.along_m[left] < way.along_m[at]:
            continue
        steady = np.flatnonzero(np.abs(leader.across_m[: left + 1]) <= WANDERING_M)
        return (leader, int(steady[-1])) if len(steady) else None
    return None
