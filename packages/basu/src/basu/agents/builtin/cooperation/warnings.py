"""Warnings of people: a person that another vehicle sees counts for a second as if this vehicle saw it.

A warning is a text: `DENM 12 ID X Y VX VY`. 12 is the cause "human presence on the road" of ETSI EN 302 637-3. Then
come the person's actor id, its place in m and its velocity in m/s in CARLA's world frame.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from basu.agents.builtin.scene import ActorKind, Other

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

KEPT_S = 1.0
MOST = 5  # warnings at a time: the nearest people
HEAD = ["DENM", "12"]


class Warned(NamedTuple):
    """A person that a warning tells of."""

    person_id: int
    x_m: float
    y_m: float
    velocity_x_mps: float
    velocity_y_mps: float

    def at(self, age_s: float) -> Other:
        """Return the person as an actor, moved on for the age of the warning."""
        x_m, y_m = self.x_m + age_s * self.velocity_x_mps, self.y_m + age_s * self.velocity_y_mps
        velocity = (self.velocity_x_mps, self.velocity_y_mps)
        return Other(self.person_id, ActorKind.WALKER, x_m, y_m, 0.0, *velocity, 0.0, 0.25, 0.25)


def read_warning(text: str) -> Warned | None:
    """Return a warning, None where the text is none: a stranger may send anything."""
    words = text.split()
    try:
        person_id, *numbers = words[2:]
        found = Warned(int(person_id), *map(float, numbers)) if words[:2] == HEAD else None
    except (TypeError, ValueError):
        return None
    return found if found is not None and all(map(math.isfinite, found[1:])) else None


def warnings_of(seen: Sequence[Other], x_m: float, y_m: float) -> list[str]:
    """Return the texts about the nearest people among the actors that are seen from a place, in CARLA's frame."""
    people = [other for other in seen if other.kind is ActorKind.WALKER and other.unseen_s == 0.0]
    people.sort(key=lambda person: (person.x_m - x_m) ** 2 + (person.y_m - y_m) ** 2)
    return [_text(person) for person in people[:MOST]]


def _text(person: Other) -> str:
    numbers = (person.x_m, person.y_m, person.velocity_x_mps, person.velocity_y_mps)
    return " ".join([*HEAD, str(person.id), *(f"{number:.2f}" for number in numbers)])


class WarnedPeople:
    """The people that other vehicles warn of.

    Attributes:
        known: each warning with the time in s at which it was heard, by the person's id.
    """

    def __init__(self) -> None:
        """Know of no person."""
        self.known: dict[int, tuple[Warned, float]] = {}

    def hear(self, texts: Sequence[str], now_s: float) -> None:
        """Take in what was heard, and forget what is too old."""
        for text in texts:
            if (warned := read_warning(text)) is not None:
                self.known[warned.person_id] = warned, now_s
        self.known = {number: (warned, s) for number, (warned, s) in self.known.items() if now_s - s <= KEPT_S}

    def unseen(self, seen_ids: Collection[int], now_s: float) -> list[Other]:
        """Return the people that are known from warnings alone."""
        return [warned.at(now_s - s) for number, (warned, s) in self.known.items() if number not in seen_ids]
