"""The cabin of a shuttle: seats, room to stand, the place for a wheelchair, and which passenger takes which.

The EasyMile EZ10 of Linden has 6 seats and takes 12 passengers (METRO Magazine, 13 February 2020; EasyMile). What a
wheelchair or a pushchair takes of the room to stand is an assumption of this project.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass, field

from basu.metrics.passengers.service import CAPACITY
from basu_service.persons import Kind, Person

SEATS = 6
STANDING_ROOM = CAPACITY - SEATS
ROOM = {Kind.WHEELCHAIR: 2, Kind.PUSHCHAIR: 1}  # standing passengers that would fit there
MOST = {Kind.WHEELCHAIR: 1, Kind.PUSHCHAIR: 2}


class Space(enum.Enum):
    """The kind of place in the cabin that a passenger takes."""

    SEAT = "seat"
    STANDING = "standing"
    WHEELCHAIR_PLACE = "wheelchair_place"


class Refusal(enum.Enum):
    """The reason why a person cannot board a vehicle."""

    FULL = "full"
    NO_SEAT = "no_seat"  # for a person that cannot ride standing
    PLACE_TAKEN = "place_taken"  # of the wheelchair or the pushchairs


@dataclass(slots=True)
class Cabin:
    """The passengers aboard and their places, in the order of boarding."""

    aboard: dict[int, tuple[Person, Space]] = field(default_factory=dict)  # by the person's number

    def _count(self, space: Space) -> int:
        return sum(each is space for _, each in self.aboard.values())

    def _kinds(self, kind: Kind) -> int:
        return sum(person.kind is kind for person, _ in self.aboard.values())

    @property
    def standing(self) -> int:
        """The number of standing passengers."""
        return self._count(Space.STANDING)

    @property
    def _free_seats(self) -> int:
        return SEATS - self._count(Space.SEAT)

    @property
    def _free_room(self) -> int:
        taken = sum(ROOM[kind] * self._kinds(kind) for kind in ROOM)
        return STANDING_ROOM - self.standing - taken

    def refusal(self, person: Person) -> Refusal | None:
        """Return why a person does not fit in; None for a person that does."""
        if person.kind in MOST and self._kinds(person.kind) >= MOST[person.kind]:
            return Refusal.PLACE_TAKEN
        room = self._free_room - ROOM.get(person.kind, 0)
        if room < 0:
            return Refusal.FULL
        if person.kind is Kind.WHEELCHAIR or self._free_seats > 0:
            return None
        if person.needs_seat and room > 0 and self._gives_up_seat() is None:
            return Refusal.NO_SEAT
        return None if room > 0 else Refusal.FULL

    def board(self, person: Person) -> None:
        """Give a person that fits in a place; a seated passenger stands up for a person that needs a seat."""
        if person.kind is Kind.WHEELCHAIR:
            self.aboard[person.number] = person, Space.WHEELCHAIR_PLACE
            return
        if person.needs_seat and self._free_seats == 0:
            number = self._gives_up_seat()
            assert number is not None, "`refusal` was asked"
            self.aboard[number] = self.aboard[number][0], Space.STANDING
        stands = self._free_seats == 0 or (person.likes_standing and self._free_room > 0)
        self.aboard[person.number] = person, Space.STANDING if stands else Space.SEAT

    def alight(self, person: Person) -> None:
        """Let a passenger out."""
        del self.aboard[person.number]

    def settle(self) -> None:
        """Let standing passengers take free seats, in the order of boarding."""
        for number, (person, space) in self.aboard.items():
            if space is Space.STANDING and not person.likes_standing and self._free_seats > 0:
                self.aboard[number] = person, Space.SEAT

    def _gives_up_seat(self) -> int | None:
        """Return the number of the seated passenger that stands up for another: the last that boarded and can stand."""
        able = [
            number
            for number, (person, space) in self.aboard.items()
            if space is Space.SEAT and not person.needs_seat and person.kind is Kind.ON_FOOT
        ]
        return able[-1] if able else None
