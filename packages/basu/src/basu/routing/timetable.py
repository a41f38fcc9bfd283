"""Timetable of a bus service: its times, and when each round is due at each stop; from a JSON file that a route names.

    {"schema_version": 1, "round": "24:00", "headway": "12:00",
     "service": [{"days": ["Mon"], "from": "06:00", "to": "08:00"}],
     "run": {"day": "Mon", "departure": "07:00"},
     "calls": [{"stop": "S1", "arrival": "00:00", "departure": "00:20"}]}

``service`` and ``run`` count hours and minutes of the day, all else minutes and seconds from a round's departure.
``run`` says which departure a drive of the route stands for; a drive begins at that time.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.files import read_json

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable
    from pathlib import Path

SCHEMA_VERSION = 1
DAYS = ("Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun")


@dataclass(frozen=True, slots=True, kw_only=True)
class Call:
    """What is due at one stop, s from the round's departure."""

    stop_id: str
    arrival_s: float
    departure_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Hours:
    """A stretch of a day in which rounds begin, s from midnight; the last begins before its end."""

    days: tuple[str, ...]
    from_s: float
    to_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Timetable:
    """A service on one route."""

    round_s: float  # from departure to departure of one vehicle at the first stop
    headway_s: float  # from one vehicle to the next
    service: tuple[Hours, ...]
    run_day: str
    run_departure_s: float  # from midnight
    calls: tuple[Call, ...]  # in the order of the route

    def departures_s(self, day: str) -> tuple[float, ...]:
        """When rounds begin on a day, s from midnight: one each headway from the beginning of each stretch."""
        found: set[float] = set()
        for hours in self.service:
            if day in hours.days:
                count = int(-(-(hours.to_s - hours.from_s) // self.headway_s))
                found.update(hours.from_s + number * self.headway_s for number in range(count))
        return tuple(sorted(found))


def read_timetable(path: Path, stop_ids: Collection[str]) -> Timetable:
    """Read a timetable of a route with these stops.

    Raises:
        UserError: the file is missing or no timetable of this route; the sentence says where and what.
    """
    document = read_json(path, "the timetable")
    try:
        timetable = timetable_from_json(document)
    except KeyError as error:
        raise UserError(f"the timetable {path} lacks {error}") from error
    except (TypeError, ValueError) as error:
        raise UserError(f"the timetable {path}: {error}") from error
    strangers = [call.stop_id for call in timetable.calls if call.stop_id not in stop_ids]
    if strangers:
        raise UserError(
            f"the timetable {path} calls at '{strangers[0]}', which is no stop of its route; it has "
            f"{', '.join(stop_ids) or 'none'}"
        )
    return timetable


def timetable_from_json(document: dict[str, Any]) -> Timetable:
    """Read what a file or :func:`timetable_to_json` has; KeyError, TypeError, ValueError say what is wrong."""
    if document["schema_version"] != SCHEMA_VERSION:
        raise ValueError(f"schema_version is {document['schema_version']}, and only {SCHEMA_VERSION} can be read")
    timetable = Timetable(
        round_s=_minutes(document["round"], "round"),
        headway_s=_minutes(document["headway"], "headway"),
        service=tuple(_hours(entry) for entry in document["service"]),
        run_day=_day(document["run"]["day"]),
        run_departure_s=60.0 * _minutes(document["run"]["departure"], "departure of the run"),
        calls=tuple(
            Call(
                stop_id=str(entry["stop"]),
                arrival_s=_minutes(entry["arrival"], f"arrival at {entry['stop']}"),
                departure_s=_minutes(entry["departure"], f"departure from {entry['stop']}"),
            )
            for entry in document["calls"]
        ),
    )
    _check(timetable)
    return timetable


def timetable_to_json(timetable: Timetable) -> dict[str, Any]:
    """Return a timetable as a file has it."""
    return {
        "schema_version": SCHEMA_VERSION,
        "round": _written(timetable.round_s),
        "headway": _written(timetable.headway_s),
        "service": [
            {"days": list(hours.days), "from": _written(hours.from_s / 60.0), "to": _written(hours.to_s / 60.0)}
            for hours in timetable.service
        ],
        "run": {"day": timetable.run_day, "departure": _written(timetable.run_departure_s / 60.0)},
        "calls": [
            {"stop": call.stop_id, "arrival": _written(call.arrival_s), "departure": _written(call.departure_s)}
            for call in timetable.calls
        ],
    }


def _check(timetable: Timetable) -> None:
    """Refuse a timetable that contradicts itself."""
    if timetable.headway_s <= 0.0:
        raise ValueError("the headway is 0; it is the time from one vehicle to the next")
    latest_s = 0.0
    for call in timetable.calls:
        if not latest_s <= call.arrival_s <= call.departure_s <= timetable.round_s:
            raise ValueError(
                f"the call at {call.stop_id} ({_written(call.arrival_s)} to {_written(call.departure_s)}) does not lie "
                f"between the one before it ({_written(latest_s)}) and the round's end ({_written(timetable.round_s)})"
            )
        latest_s = call.departure_s
    if timetable.run_departure_s not in timetable.departures_s(timetable.run_day):
        raise ValueError(
            f"no round departs on {timetable.run_day} at {_written(timetable.run_departure_s / 60.0)}; there is one "
            f"each {_written(timetable.headway_s)} from the beginning of each stretch of service"
        )


def _hours(entry: dict[str, Any]) -> Hours:
    """Read one stretch of service."""
    from_s, to_s = (60.0 * _minutes(entry[key], f"'{key}' of the service") for key in ("from", "to"))
    if to_s <= from_s:
        raise ValueError(f"a stretch of service goes from {entry['from']} to {entry['to']}, which is not later")
    return Hours(days=tuple(_days(entry["days"])), from_s=from_s, to_s=to_s)


def _days(given: object) -> Iterable[str]:
    """Read the names of days."""
    if not isinstance(given, list) or not given:
        raise TypeError(f"'days' is {given!r}; write a list such as ['Mon', 'Tue']")
    return [_day(day) for day in given]


def _day(name: object) -> str:
    """Return the name of a day."""
    if name not in DAYS:
        raise ValueError(f"{name!r} is no day; write one of {', '.join(DAYS)}")
    return str(name)


def _minutes(text: object, what: str) -> float:
    """``12:30`` as 750: minutes and seconds as s, and hours and minutes as minutes."""
    big, colon, small = str(text).partition(":")
    if not isinstance(text, str) or not colon or not (big.isdecimal() and small.isdecimal()) or int(small) > 59:
        raise ValueError(f"the {what} is {text!r}; write two numbers with a colon, such as '12:30'")
    return 60.0 * int(big) + int(small)


def _written(value: float) -> str:
    """Return a time or headway as it stands in a file, with two parts of two digits."""
    big, small = divmod(round(value), 60)
    return f"{big:02d}:{small:02d}"
