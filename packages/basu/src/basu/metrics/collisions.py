"""Collisions: sensor messages brought together into contacts, each with its responsibility by `basu.metrics.fault`.

The thesis counts every collision (section 5.2.1). The responsibility is reported beside it and changes no score.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

from basu.metrics.fault import responsibility
from basu.metrics.infraction import DEFAULT_PENALTIES, Evidence, Infraction, Responsibility, evidence
from basu.metrics.json_schema import integer, record
from basu.metrics.registry import Column, Drive, Metric, register

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu.metrics.registry import JudgedRun, Watcher
    from basu.metrics.scoring import Scoring
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
        if before is None or is_separate(tick - before, history.facts.step_s):
            found.append(event)
    return tuple(found)


def is_separate(ticks: Any, step_s: float) -> Any:  # noqa: ANN401 - a number or an array
    """Return whether a message begins another contact, ``ticks`` after the party's latest one."""
    return ticks * step_s > SEPARATE_AFTER_S


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


def responsibilities(history: History) -> tuple[tuple[Evidence, Responsibility], ...]:
    """Each collision of a drive, as `collisions` counts them, with its responsibility."""
    return tuple(
        (found, responsibility(history, event))
        for found, event in zip(collisions(history), beginnings(history, {}), strict=True)
    )


LATE_S = 1.0  # a message that comes later than this after its frame is judged at the end only


class CollisionsSoFar:
    """The contacts until now; ``pending`` holds those of the last second, which a late message may precede."""

    def __init__(self) -> None:
        self.settled: list[Evidence] = []
        self.pending: list[Evidence] = []
        self._latest: dict[Party, int] = {}
        self._first = 0  # messages before this tick are settled

    def look(self, window: Callable[[int], History]) -> None:
        """Take in what is new."""
        since = max(0, self._first - 1)  # the frame before a contact tells its speed
        history = window(since)
        settled = max(self._first, since + len(history.frames) - round(LATE_S / history.facts.step_s))
        fresh = [event for event in history.collisions if event.tick + since >= self._first]
        old = replace(history, collisions=tuple(event for event in fresh if event.tick + since < settled))
        new = replace(history, collisions=tuple(event for event in fresh if event.tick + since >= settled))
        self.settled += [replace(event, tick=event.tick + since) for event in contacts(old, self._latest)]
        self.pending = [replace(event, tick=event.tick + since) for event in contacts(new, dict(self._latest))]
        self._first = settled


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
        """Return the number of contacts, and of those by the vehicle's own fault."""
        found = [blame.at_fault for _, blame in responsibilities(drive.history)]
        return {"number": len(found), "at_fault": sum(found)}

    def watch(self, scoring: Scoring) -> Watcher:  # noqa: ARG002 - no rule of scoring changes them
        """Return what finds the events while a drive lasts."""
        return CollisionsSoFar()

    def find(self, drive: Drive) -> tuple[Evidence, ...]:
        """Return the evidence of each contact."""
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
