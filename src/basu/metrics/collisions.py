"""Collisions: sensor messages brought together into contacts, and each contact's responsibility by nuPlan's rule.

Source: ``no_ego_at_fault_collisions.py`` of motional/nuplan-devkit (``nuplan/planning/metrics/evaluation_metrics/
common``), with ``is_agent_behind`` of ``planning/simulation/observation/idm/utils.py``. In its order:

    the ego stands                                            not at fault
    the other stands, or is a thing                           at fault
    the ego reverses, and the other is behind it              at fault
    the other's middle lies behind the ego's rear axle        not at fault
    the other comes head-on into the ego's own lane           not at fault
    the ego's front bumper meets the other                    at fault
    otherwise the ego's side meets the other                  at fault where the ego is not within one lane

Two clauses are by the rules of the road and not nuPlan's: those on reversing and on head-on vehicles.
The ego is in its own lane where its whole box lies within one and points along it.

nuPlan's bodies pass through one another, and it looks at the first frame of overlap. Here a contact changes both
speeds, so speeds and headings are those of the frame before the contact. nuPlan calls an ego stopped at 0.05 m/s and
another at 0.005 m/s; a body at rest in a physics engine creeps by more than that, so 0.05 m/s holds for both.

The thesis counts every collision (section 5.2.1). The responsibility is reported beside it and changes no score.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from basu.metrics.boxes import other_boxes, own_boxes, touching
from basu.metrics.infraction import DEFAULT_PENALTIES, CollisionKind, Evidence, Infraction, Responsibility, evidence
from basu.metrics.json_schema import integer, record
from basu.metrics.registry import Column, Drive, Metric, register

if TYPE_CHECKING:
    from basu.metrics.registry import JudgedRun
    from basu.records.history import Collision, History


# A contact with one party lasts until it has not been reported for so long: a vehicle that rebounds from a wall and
# leans on it again has hit it once. The CARLA leaderboard, too, counts a second touch of one actor only after a while.
SEPARATE_AFTER_S = 2.0

Party = tuple[int, str]  # actor id and type: scenery has no id but 0


def collisions(history: History) -> tuple[Evidence, ...]:
    """One infraction for each contact, at its first frame, with the speed of the frame before it."""
    return contacts(history, {})


def contacts(history: History, latest: dict[Party, int]) -> tuple[Evidence, ...]:
    """The contacts that begin in this record, which may be the later part of one; ``latest`` as in `beginnings`."""
    return tuple(_contact(history, event) for event in beginnings(history, latest))


def beginnings(history: History, latest: dict[Party, int]) -> tuple[Collision, ...]:
    """The first message of each contact.

    ``latest`` holds the tick of each party's latest message until then, and is brought up to date.
    """
    ticks = history.frames["tick"]
    found = []
    for event in history.collisions:
        party, tick = (event.other_id, event.other_type), int(ticks[event.tick])
        before = latest.get(party)
        latest[party] = tick
        if before is None or (tick - before) * history.facts.step_s > SEPARATE_AFTER_S:
            found.append(event)
    return tuple(found)


def kind_of(other_type: str) -> Infraction:
    """What was hit, from its blueprint id; everything that is neither walker nor vehicle is static."""
    if other_type.startswith("walker."):
        return Infraction.COLLISION_PEDESTRIAN
    if other_type.startswith("vehicle."):
        return Infraction.COLLISION_VEHICLE
    return Infraction.COLLISION_STATIC


def _contact(history: History, event: Collision) -> Evidence:
    """The evidence of a contact that begins with ``event``."""
    speed_mps = float(history.speed_mps()[max(0, event.tick - 1)])
    impulse_ns = math.hypot(*event.impulse_ns)
    other = event.other_type if event.other_id == 0 else f"{event.other_type} (actor {event.other_id})"
    return evidence(
        history,
        kind_of(event.other_type),
        event.tick,
        speed_mps=speed_mps,
        other=other,
        detail=f"hit {other} at {speed_mps:.2f} m/s with an impulse of {impulse_ns:.0f} N s",
    )


STOPPED_MPS = 0.05
BEHIND_RAD = math.radians(150.0)  # between the ego's heading and the direction to the other's middle
HEAD_ON_RAD = math.radians(150.0)  # between the two courses; a vehicle that crosses or turns comes at less
AGAINST_RAD = math.radians(90.0)  # between the ego's heading and its lane's
BUMPER_M = 0.25  # a box this near to the front bumper meets it: in a step of 0.05 s, 5 m/s go as far


def responsibilities(history: History) -> tuple[tuple[Evidence, Responsibility], ...]:
    """Each collision of a drive, as `collisions` counts them, with its responsibility."""
    return tuple(
        (found, responsibility(history, event))
        for found, event in zip(collisions(history), beginnings(history, {}), strict=True)
    )


def responsibility(history: History, event: Collision) -> Responsibility:
    """The responsibility for the contact that begins with ``event``, from the record alone.

    An actor that the record does not hold is taken for a thing that stands: every vehicle and walker that is near
    enough to touch is in the record.
    """
    before = max(0, event.tick - 1)
    speed_mps = float(history.speed_mps()[before])
    if speed_mps <= STOPPED_MPS:
        return _not_at_fault(CollisionKind.STOPPED_EGO, f"the ego stood ({speed_mps:.2f} m/s) when it was struck")
    other = _row(history, event.other_id, before)
    other_mps = 0.0 if other is None else math.hypot(other["velocity_x_mps"], other["velocity_y_mps"])
    if other is None or other_mps <= STOPPED_MPS:
        return _at_fault(CollisionKind.STOPPED_OTHER, f"the ego drove at {speed_mps:.2f} m/s into what stood still")
    if _is_behind(history, before, other):
        if _along_mps(history, before) < -STOPPED_MPS:
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


def within_one_lane(history: History, tick: int) -> bool:
    """Whether the whole box of the ego lies in one lane; in a junction, where lanes overlap, in the planned one.

    nuPlan asks whether all corners of the ego's box lie in one lane or in connected ones.
    """
    frame, route = history.frames[tick], history.facts.route
    if frame["in_junction"]:
        index = max(0, int(np.searchsorted(route.s_m, frame["route_s_m"], side="right")) - 1)
        offset_m, width_m = float(frame["lateral_m"]), float(route.lane_width_m[index])
        heading_rad = float(frame["yaw_rad"]) - float(
            np.interp(frame["route_s_m"], route.s_m, np.unwrap(route.yaw_rad))
        )
    else:
        offset_m, width_m = float(frame["lane_offset_m"]), float(frame["lane_width_m"])
        heading_rad = float(frame["lane_heading_rad"])
    if not (math.isfinite(offset_m) and math.isfinite(width_m)) or frame["off_lane_m"] > 0.0:
        return False
    vehicle = history.facts.vehicle
    corners_m = [
        offset_m + along_m * math.sin(heading_rad) + beside_m * math.cos(heading_rad)
        for along_m in (vehicle.front_m, -vehicle.rear_m)
        for beside_m in (vehicle.width_m / 2.0, -vehicle.width_m / 2.0)
    ]
    return max(map(abs, corners_m)) <= width_m / 2.0


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


@register
class Collisions(Metric):
    """How often the vehicle touched something, and how often it was at fault."""

    name = "collisions"
    title = "collisions"
    order = 10
    schema = record(
        null_=True,
        about_="contacts, and those for which the vehicle under test is at fault",
        number=integer(low=0),
        at_fault=integer(low=0),
    )
    penalties: ClassVar[dict[str, float]] = {
        kind.value: DEFAULT_PENALTIES[kind]
        for kind in (Infraction.COLLISION_PEDESTRIAN, Infraction.COLLISION_VEHICLE, Infraction.COLLISION_STATIC)
    }

    def compute(self, drive: Drive) -> dict[str, int]:
        """The two numbers."""
        found = [blame.at_fault for _, blame in responsibilities(drive.history)]
        return {"number": len(found), "at_fault": sum(found)}

    def find(self, drive: Drive) -> tuple[Evidence, ...]:
        """Each contact."""
        return collisions(drive.history)

    def lines(self, result: JudgedRun) -> list[str]:
        """A line where there was one."""
        found = result.metrics[self.name]
        if not found["number"]:
            return []
        return [f"{self.title:<18}{found['number']}, at fault for {found['at_fault']} of them"]

    def columns(self, result: JudgedRun) -> list[Column]:
        """The number, and that of the collisions at fault."""
        found = result.metrics[self.name] or {"number": 0, "at_fault": 0}
        return [Column("collisions", str(found["number"])), Column("collisions at fault", str(found["at_fault"]))]
