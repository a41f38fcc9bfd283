"""The operation of a service: doors, boarding, holding and the persons at the stops and aboard, step by step.

`Service.step` takes where each vehicle is and says whether its parking brake holds it. It knows no simulator, so that a
test can play it with vehicles of its own.

::

    DRIVING ── rests at a stop ──► OPENING ──► SERVING ── all aboard ──► CLOSING ──► CLOSED
       ▲                              ▲                                              │  │
       │                              └──────────── a person comes ──────────────────┘  │
       └──────────────────────────── leaves ────────────────────────────────────────────┘

The parking brake holds the vehicle from OPENING to CLOSING. So no vehicle leaves with open doors, and a vehicle that
moves takes no person in.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from basu.metrics.passengers.service import ONE_ALIGHTS_S, ONE_BOARDS_S
from basu_service.cabin import Cabin, Space
from basu_service.persons import Kind, Person

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

REST_S = 0.5  # at rest before the doors open, so that a vehicle that rolls opens none
DOOR_S = 1.5
"""For the doors to open, and again to close: 2 to 5 s for both (Transit Capacity and Quality of Service Manual, 3rd
ed., TCRP Report 165, 2013, chapter 6, quoted from memory)."""
STANDEES_S = 0.5  # more for each that boards where passengers stand: the same chapter, from memory
WHEELCHAIR_S = 45.0
"""For one wheelchair over a ramp, in or out, with securing it: the middle of 30 to 60 s there, from memory."""
PUSHCHAIR_FACTOR = 2.0  # of the time of a person on foot: an assumption of this project
MOST_REST_S = 120.0
"""Longest hold at a stop, and the time after which doors open no more. The stops lie in the lane. A drive ends as
blocked when the vehicle has stood for 180 s."""


class Phase(enum.Enum):
    """What the doors of a vehicle do."""

    DRIVING = "driving"
    OPENING = "opening"
    SERVING = "serving"
    CLOSING = "closing"
    CLOSED = "closed"  # at rest at the stop, ready to leave


class Seen(NamedTuple):
    """One vehicle in one step."""

    stop_id: str | None  # the stop at which it could board, if it rested
    rests: bool  # at rest, on its route
    goes: bool  # its agent asks for throttle


@dataclass(slots=True)
class Call:
    """One visit of a vehicle at a stop; times in s from the beginning of the service."""

    vehicle: int
    stop_id: str
    arrival_s: float
    closed_s: float | None = None  # when the doors were closed last
    departure_s: float | None = None  # None: it still stands there
    boarded: int = 0
    alighted: int = 0
    left_behind: int = 0
    held_since_s: float | None = None
    held_s: float = 0.0  # with open doors for the timetable, from the first moment with a free door
    planned_departure_s: float | None = None


@dataclass(slots=True)
class Journey:
    """One person's way; times in s from the beginning of the service, None for what has not happened."""

    person: Person
    vehicle: int | None = None
    boarded_s: float | None = None
    alighted_s: float | None = None
    gave_up_s: float | None = None
    left_behind: list[tuple[float, str]] = field(default_factory=list)  # when a vehicle left without it, and why
    carried_past: int = 0  # how often the destination was passed with the person aboard
    stood: list[tuple[float, float | None]] = field(default_factory=list)  # from and to; None: still

    @property
    def waits(self) -> bool:
        """Whether the person stands at its stop, if it has come."""
        return self.boarded_s is None and self.gave_up_s is None

    def stands_there(self, t_s: float) -> bool:
        """Return whether the person stands at its stop at a time."""
        came_s = self.person.came_s
        return self.waits and came_s <= t_s <= came_s + self.person.patience_s


@dataclass(slots=True)
class _Doors:
    """One vehicle of the service: its cabin, the phase of its doors, and its calls."""

    cabin: Cabin = field(default_factory=Cabin)
    phase: Phase = Phase.DRIVING
    rests_since_s: float | None = None
    until_s: float = 0.0  # of the phase, or of the person in the door
    call: Call | None = None
    calls_at: dict[str, int] = field(default_factory=dict)


class Service:
    """All vehicles, stops and persons of a service.

    Attributes:
        journeys: of each person, by its number.
        calls: the visits at stops, in the order of arrival.
        passed: stops that a vehicle passed without a call: time, vehicle, stop, persons that waited for it there.
        aboard: how many passengers a vehicle had from a time on: time, vehicle, passengers, of which stand.
    """

    def __init__(
        self,
        persons: Sequence[Person],
        vehicles: int,
        planned_departure_s: Callable[[int, str, int], float | None] = lambda _vehicle, _stop, _call: None,
    ) -> None:
        """Begin with empty vehicles.

        ``planned_departure_s`` has the time before which the doors stay open, by vehicle, stop and number of the
        vehicle's call there, from 0; None where nothing is planned.
        """
        self.journeys = [Journey(person) for person in persons]
        self.calls: list[Call] = []
        self.passed: list[tuple[float, int, str, int]] = []
        self.aboard: list[tuple[float, int, int, int]] = []
        self._planned_s = planned_departure_s
        self._vehicles = [_Doors() for _ in range(vehicles)]
        self._at: dict[str, list[Journey]] = {}
        for journey in self.journeys:
            self._at.setdefault(journey.person.stop_id, []).append(journey)

    def step(self, t_s: float, vehicle: int, seen: Seen) -> bool:
        """Let a vehicle serve its stop; return whether its parking brake holds it."""
        doors = self._vehicles[vehicle]
        serves = seen.rests and seen.stop_id is not None
        doors.rests_since_s = None if not serves else t_s if doors.rests_since_s is None else doors.rests_since_s
        if doors.phase is Phase.DRIVING:
            if serves and doors.rests_since_s is not None and t_s - doors.rests_since_s >= REST_S - 1e-6:
                self._open(doors, vehicle, str(seen.stop_id), t_s)
        elif doors.phase is Phase.CLOSED:
            self._closed(doors, t_s, seen)
        elif t_s >= doors.until_s - 1e-6:
            self._go_on(doors, vehicle, t_s)
        return doors.phase in (Phase.OPENING, Phase.SERVING, Phase.CLOSING)

    def _open(self, doors: _Doors, vehicle: int, stop_id: str, t_s: float) -> None:
        """Begin a call."""
        number = doors.calls_at.get(stop_id, 0)
        doors.calls_at[stop_id] = number + 1
        doors.call = Call(vehicle, stop_id, t_s, planned_departure_s=self._planned_s(vehicle, stop_id, number))
        self.calls.append(doors.call)
        doors.phase, doors.until_s = Phase.OPENING, t_s + DOOR_S

    def _closed(self, doors: _Doors, t_s: float, seen: Seen) -> None:
        """End a call where the vehicle has left; open again for a person that comes while the vehicle rests."""
        call = doors.call
        assert call is not None, "doors close at a stop"
        if not seen.rests or seen.stop_id != call.stop_id:
            call.departure_s = t_s
            for journey in self._waiting(call.stop_id, t_s):
                call.left_behind += 1
                why = doors.cabin.refusal(journey.person)
                journey.left_behind.append((t_s, "doors_closed" if why is None else why.value))
            doors.phase, doors.call = Phase.DRIVING, None
        elif not seen.goes and t_s - call.arrival_s < MOST_REST_S and self._next(doors, call.stop_id, t_s) is not None:
            doors.phase, doors.until_s = Phase.OPENING, t_s + DOOR_S

    def _go_on(self, doors: _Doors, vehicle: int, t_s: float) -> None:
        """Begin what comes next at a stop: a person in the door, a hold, closing, or rest with closed doors."""
        call = doors.call
        assert call is not None, "doors move at a stop"
        if doors.phase is Phase.CLOSING:
            doors.phase, call.closed_s = Phase.CLOSED, t_s
            return
        doors.phase = Phase.SERVING
        busy_s = self._through_door(doors, vehicle, call, t_s)
        if busy_s is not None:
            doors.until_s = t_s + busy_s
            return
        latest_s = call.arrival_s + MOST_REST_S
        if call.planned_departure_s is not None and t_s + DOOR_S < min(call.planned_departure_s, latest_s):
            call.held_since_s = t_s if call.held_since_s is None else call.held_since_s
            return
        call.held_s = 0.0 if call.held_since_s is None else t_s - call.held_since_s
        doors.phase, doors.until_s = Phase.CLOSING, t_s + DOOR_S

    def _through_door(self, doors: _Doors, vehicle: int, call: Call, t_s: float) -> float | None:
        """Let the next person alight or board; return how long that takes, None where no person is left."""
        cabin = doors.cabin
        leaving = [person for person, _ in cabin.aboard.values() if person.destination_id == call.stop_id]
        if leaving:
            person = leaving[0]
            self._mark(vehicle, t_s, lambda: cabin.alight(person))
            self.journeys[person.number].alighted_s = t_s
            call.alighted += 1
            return _door_s(person, ONE_ALIGHTS_S)
        boarding = self._next(doors, call.stop_id, t_s)
        if boarding is None:
            self._mark(vehicle, t_s, cabin.settle)
            return None
        boarding.vehicle, boarding.boarded_s = vehicle, t_s
        takes_s = _door_s(boarding.person, ONE_BOARDS_S) + (STANDEES_S if cabin.standing else 0.0)
        self._mark(vehicle, t_s, lambda: cabin.board(boarding.person))
        call.boarded += 1
        return takes_s

    def _next(self, doors: _Doors, stop_id: str, t_s: float) -> Journey | None:
        """Return the next that boards: wheelchairs first, then in the order of coming; None where no person fits in."""
        fitting = [each for each in self._waiting(stop_id, t_s) if doors.cabin.refusal(each.person) is None]
        fitting.sort(key=lambda each: (each.person.kind is not Kind.WHEELCHAIR, each.person.number))
        return fitting[0] if fitting else None

    def _waiting(self, stop_id: str, t_s: float) -> list[Journey]:
        """Return the persons that wait at a stop; a person without patience has given up."""
        found = []
        for journey in self._at.get(stop_id, ()):
            if journey.person.came_s > t_s:
                break
            if journey.waits and journey.person.came_s + journey.person.patience_s < t_s:
                journey.gave_up_s = journey.person.came_s + journey.person.patience_s
            if journey.waits:
                found.append(journey)
        return found

    def _mark(self, vehicle: int, t_s: float, change: Callable[[], None]) -> None:
        """Change the cabin, and note the passengers that stand from now on or no more."""
        cabin = self._vehicles[vehicle].cabin
        before = {number for number, (_, space) in cabin.aboard.items() if space is Space.STANDING}
        change()
        after = {number for number, (_, space) in cabin.aboard.items() if space is Space.STANDING}
        for number in sorted(after - before):
            self.journeys[number].stood.append((t_s, None))
        for number in sorted(before - after):
            stood = self.journeys[number].stood
            stood[-1] = stood[-1][0], t_s
        self.aboard.append((t_s, vehicle, len(cabin.aboard), len(after)))

    def has_passed(self, t_s: float, vehicle: int, stop_id: str) -> None:
        """Note that a vehicle is beyond a stop at which it did not open its doors."""
        waiting = self._waiting(stop_id, t_s)
        for journey in waiting:
            journey.left_behind.append((t_s, "passed"))
        for person, _ in self._vehicles[vehicle].cabin.aboard.values():
            if person.destination_id == stop_id:
                self.journeys[person.number].carried_past += 1
        self.passed.append((t_s, vehicle, stop_id, len(waiting)))

    def finish(self, t_s: float) -> None:
        """Let the persons give up that have lost patience by the end of the service."""
        for stop_id in self._at:
            self._waiting(stop_id, t_s)


def _door_s(person: Person, on_foot_s: float) -> float:
    """Return how long a person takes in the door."""
    if person.kind is Kind.WHEELCHAIR:
        return WHEELCHAIR_S
    return on_foot_s * (PUSHCHAIR_FACTOR if person.kind is Kind.PUSHCHAIR else 1.0)
