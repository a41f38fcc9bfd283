"""Fault: the responsibility for a collision, by the rules of the road where they decide, by nuPlan's rule otherwise.

One function answers, `responsibility`, from the record alone; every reader asks it. In its order:

    the ego took the right of way (`basu.metrics.right_of_way`)   at fault
    the ego stands                                                not at fault
    the other stands, or is a thing                               at fault
    the ego reverses, and the other is behind it                  at fault
    the other's middle lies behind the ego's rear axle            not at fault
    the other comes head-on into the ego's own lane               not at fault
    the ego's front bumper meets the other                        at fault
    otherwise the ego's side meets the other                      at fault where the ego is not within one lane

The clauses on the right of way, on reversing and on head-on vehicles are by the rules of the road. The others are
nuPlan's: ``no_ego_at_fault_collisions.py`` of motional/nuplan-devkit (``nuplan/planning/metrics/evaluation_metrics/
common``), with ``is_agent_behind`` of ``planning/simulation/observation/idm/utils.py``. The kind is always nuPlan's.
The ego is in its own lane where its whole box lies within one and points along it.

nuPlan's bodies pass through one another, and it looks at the first frame of overlap. Here a contact changes both
speeds, so speeds and headings are those of the frame before the contact. nuPlan calls an ego stopped at 0.05 m/s and
another at 0.005 m/s; a body at rest in a physics engine creeps by more than that, so 0.05 m/s holds for both.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.boxes import other_boxes, own_boxes, touching
from basu.metrics.infraction import CollisionKind, Responsibility
from basu.metrics.lanes import within_one_lane
from basu.metrics.right_of_way import entered_on_red, entered_path, not_yielded, track_of
from basu.thresholds import STANDSTILL_MPS

if TYPE_CHECKING:
    from basu.records.history import Collision, History

BEHIND_RAD = math.radians(150.0)  # between the ego's heading and the direction to the other's middle
HEAD_ON_RAD = math.radians(150.0)  # between the two courses; a vehicle that crosses or turns comes at less
AGAINST_RAD = math.radians(90.0)  # between the ego's heading and its lane's
BUMPER_M = 0.25  # a box this near to the front bumper meets it: in a step of 0.05 s, 5 m/s go as far


def responsibility(history: History, event: Collision) -> Responsibility:
    """The responsibility for the contact that begins with ``event``, from the record alone.

    An actor that the record does not hold is taken for a thing that stands: every vehicle and walker that is near
    enough to touch is in the record.
    """
    before = max(0, event.tick - 1)
    taken = _taken(history, before, event.other_id)
    found = _by_contact(history, event, before)
    return found if taken is None else _at_fault(found.kind, taken)


def _taken(history: History, before: int, other_id: int) -> str | None:
    """How the ego took the right of way of a vehicle, or drove on red before a person, in words; None otherwise."""
    track = track_of(history, other_id, before)
    if len(track.tick) == 0 or track.speed_mps[-1] <= STANDSTILL_MPS:
        return None
    if not history.facts.actor_types.get(other_id, "").startswith("vehicle."):
        return entered_on_red(history, before)
    return not_yielded(history, before, track) or entered_path(history, before, track)


def _by_contact(history: History, event: Collision, before: int) -> Responsibility:
    """The responsibility by the contact alone: both speeds, and the sides that met."""
    speed_mps = float(history.speed_mps()[before])
    if speed_mps <= STANDSTILL_MPS:
        return _not_at_fault(CollisionKind.STOPPED_EGO, f"the ego stood ({speed_mps:.2f} m/s) when it was struck")
    other = _row(history, event.other_id, before)
    other_mps = 0.0 if other is None else math.hypot(other["velocity_x_mps"], other["velocity_y_mps"])
    if other is None or other_mps <= STANDSTILL_MPS:
        return _at_fault(CollisionKind.STOPPED_OTHER, f"the ego drove at {speed_mps:.2f} m/s into what stood still")
    if _is_behind(history, before, other):
        if _along_mps(history, before) < -STANDSTILL_MPS:
            return _at_fault(CollisionKind.REAR, f"the ego reversed at {speed_mps:.2f} m/s into the other behind it")
        return _not_at_fault(CollisionKind.REAR, f"the ego was struck from behind at {other_mps:.2f} m/s")
    if _meets_front(history, event):
        return _of_front(history, before, other)
    return _of_side(history, before)


def _of_front(history: History, before: int, other: np.void) -> Responsibility:
    """The responsibility where the ego's front met what moved."""
    if _is_oncoming(history, before, other):
        other_mps = math.hypot(other["velocity_x_mps"], other["velocity_y_mps"])
        words = f"the other came head-on at {other_mps:.2f} m/s while the ego was within its lane"
        return _not_at_fault(CollisionKind.FRONT, words)
    speed_mps = float(history.speed_mps()[before])
    return _at_fault(CollisionKind.FRONT, f"the ego's front met the other at {speed_mps:.2f} m/s")


def _of_side(history: History, before: int) -> Responsibility:
    """The responsibility where the ego's side met what moved."""
    if not within_one_lane(history, before):
        return _at_fault(CollisionKind.LATERAL, "the ego's side met the other while the ego was not within one lane")
    return _not_at_fault(CollisionKind.LATERAL, "the ego's side was struck while the ego was within its lane")


def _row(history: History, other_id: int, tick: int) -> np.void | None:
    """The row of an actor in a frame, or in the frame after it where it has only just appeared."""
    if other_id == 0:
        return None
    rows = history.others[history.others["id"] == other_id]
    rows = rows[(rows["tick"] >= tick) & (rows["tick"] <= tick + 1)]
    return rows[0] if len(rows) else None


def _is_behind(history: History, tick: int, other: np.void) -> bool:
    """Whether the other's middle is behind the rear axle, which lies about halfway down the ego's rear half."""
    frame, vehicle = history.frames[tick], history.facts.vehicle
    middle_m, length_m = (vehicle.front_m - vehicle.rear_m) / 2.0, vehicle.front_m + vehicle.rear_m
    yaw_rad, axle_m = float(frame["yaw_rad"]), middle_m - length_m / 4.0
    dx_m = float(other["x_m"]) - float(frame["x_m"]) - axle_m * math.cos(yaw_rad)
    dy_m = float(other["y_m"]) - float(frame["y_m"]) - axle_m * math.sin(yaw_rad)
    turned_rad = math.atan2(dy_m, dx_m) - yaw_rad
    return abs(math.atan2(math.sin(turned_rad), math.cos(turned_rad))) > BEHIND_RAD


def _along_mps(history: History, tick: int) -> float:
    """The ego's speed along its heading, below 0 in reverse."""
    frame = history.frames[tick]
    yaw_rad = float(frame["yaw_rad"])
    return float(frame["velocity_x_mps"] * math.cos(yaw_rad) + frame["velocity_y_mps"] * math.sin(yaw_rad))


def _is_oncoming(history: History, tick: int, other: np.void) -> bool:
    """Whether a vehicle moves against the ego's heading while the ego keeps forward within its own lane."""
    frame = history.frames[tick]
    if not history.facts.actor_types.get(int(other["id"]), "").startswith("vehicle."):
        return False
    if not within_one_lane(history, tick) or _along_mps(history, tick) <= 0.0:
        return False
    if not frame["in_junction"] and math.cos(float(frame["lane_heading_rad"])) < math.cos(AGAINST_RAD):
        return False  # it is the ego that drives in the lane of the oncoming
    course_rad = math.atan2(float(other["velocity_y_mps"]), float(other["velocity_x_mps"]))
    return math.cos(course_rad - float(frame["yaw_rad"])) < math.cos(HEAD_ON_RAD)


def _meets_front(history: History, event: Collision) -> bool:
    """Whether the other's box meets the front bumper in the frame of the contact or in the one before."""
    for tick in (event.tick, max(0, event.tick - 1)):
        other = _row(history, event.other_id, tick)
        if other is None:
            continue
        own = own_boxes(history.facts, history.frames[tick : tick + 1])
        bumper = own.copy()
        bumper[:, 0] += own[:, 3] * np.cos(own[:, 2])
        bumper[:, 1] += own[:, 3] * np.sin(own[:, 2])
        bumper[:, 3] = BUMPER_M
        if touching(bumper, other_boxes(history.facts, np.array([other])))[0]:
            return True
    return False


def _at_fault(kind: CollisionKind, sentence: str) -> Responsibility:
    return Responsibility(at_fault=True, kind=kind, sentence=f"at fault: {sentence}")


def _not_at_fault(kind: CollisionKind, sentence: str) -> Responsibility:
    return Responsibility(at_fault=False, kind=kind, sentence=f"not at fault: {sentence}")
