"""The demand of a service: persons per stop and hour, their destinations and shares of kinds; from a JSON file.

    {"schema_version": 1,
     "stops": {"S1": {"rates": [{"from": "06:00", "to": "20:00", "per_hour": 6.0}], "to": {"S4": 2, "S3E": 1}}},
     "shares": {"wheelchair": 0.02, "pushchair": 0.05, "needs_seat": 0.15, "stands": 0.1, "holds_on": 0.8},
     "patience_min": 25,
     "connections": {"S1": {"name": "CMAX", "every_min": 15, "first": "06:05", "walk_min": 2, "share": 0.4}}}

``from``, ``to`` and ``first`` are times of the day. ``to`` of a stop has the weights of its destinations.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.files import read_json

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

SCHEMA_VERSION = 1
HOUR_S = 3600.0
MOST_PER_HOUR = 2000.0  # persons at one stop: more than any shuttle carries, so a slip of the pen
KEYS = {"schema_version", "about", "stops", "shares", "patience_min", "connections"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Rate:
    """A stretch of the day with one rate; s from midnight."""

    from_s: float
    to_s: float
    per_hour: float


@dataclass(frozen=True, slots=True, kw_only=True)
class StopDemand:
    """The persons that come to one stop."""

    stop_id: str
    rates: tuple[Rate, ...]
    destinations: tuple[tuple[str, float], ...]  # stop and its share; the shares sum to 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Shares:
    """Shares of all persons, each 0 to 1."""

    wheelchair: float = 0.0
    pushchair: float = 0.0
    needs_seat: float = 0.0  # of the others: a person that cannot ride standing
    stands: float = 0.0  # of the others: a person that stands although a seat is free
    holds_on: float = 1.0  # of standing passengers: a hand at a pole or strap


@dataclass(frozen=True, slots=True, kw_only=True)
class Connection:
    """A line with departures at equal intervals that some riders go on with."""

    name: str
    every_s: float
    first_s: float  # from midnight
    walk_s: float  # from the shuttle's door to the other line
    share: float  # of the riders that alight here


@dataclass(frozen=True, slots=True, kw_only=True)
class Demand:
    """All persons of a day, as rates."""

    stops: tuple[StopDemand, ...]
    shares: Shares
    patience_s: float  # mean time after which a waiting person gives up
    connections: Mapping[str, Connection]  # by stop
    source: str  # file name, for sentences


def packaged_demand() -> Path:
    """Return the file of the demand that the service assumes for the LEAP."""
    return Path(str(files("basu_service") / "data" / "linden_leap.demand.json"))


def read_demand(path: Path, stop_ids: Collection[str]) -> Demand:
    """Read a demand for a route with these stops.

    Raises:
        UserError: the file is missing or no demand of this route; the sentence says where and what.
    """
    document = read_json(path, "the demand")
    try:
        demand = _demand(document, str(path))
    except KeyError as error:
        raise UserError(f"the demand {path} lacks {error}; docs/reference/service.md shows a whole file") from error
    except (TypeError, ValueError, AttributeError) as error:
        raise UserError(f"the demand {path}: {error}") from error
    for stop in demand.stops:
        for name in (stop.stop_id, *(each for each, _ in stop.destinations)):
            _check_stop(path, name, stop_ids)
    for name in demand.connections:
        _check_stop(path, name, stop_ids)
    return demand


def _check_stop(path: Path, name: str, stop_ids: Collection[str]) -> None:
    if name not in stop_ids:
        raise UserError(f"the demand {path} names the stop '{name}', which its route lacks; it has {_list(stop_ids)}")


def _list(names: Collection[str]) -> str:
    return ", ".join(names) or "none"


def _demand(document: dict[str, Any], source: str) -> Demand:
    """Read the document; KeyError, TypeError, ValueError and AttributeError say what is wrong."""
    if document["schema_version"] != SCHEMA_VERSION:
        raise ValueError(f"schema_version is {document['schema_version']}, and only {SCHEMA_VERSION} can be read")
    unknown = sorted(set(document) - KEYS)
    if unknown:
        raise ValueError(f"'{unknown[0]}' means nothing; a demand has {', '.join(sorted(KEYS))}")
    shares = document.get("shares", {})
    known = set(Shares.__dataclass_fields__)
    if strange := sorted(set(shares) - known):
        raise ValueError(f"the share '{strange[0]}' means nothing; there are {', '.join(sorted(known))}")
    read = Shares(**{name: _share(value, f"the share '{name}'") for name, value in shares.items()})
    if read.wheelchair + read.pushchair > 1.0 or read.needs_seat + read.stands > 1.0:
        raise ValueError(
            "the shares of wheelchairs and pushchairs, or of needs_seat and stands, are more than 1 together"
        )
    return Demand(
        stops=tuple(_stop(name, entry) for name, entry in document["stops"].items()),
        shares=read,
        patience_s=60.0 * _positive(document["patience_min"], "patience_min"),
        connections={name: _connection(name, entry) for name, entry in document.get("connections", {}).items()},
        source=source,
    )


def _stop(name: str, entry: dict[str, Any]) -> StopDemand:
    rates = tuple(_rate(name, each) for each in entry["rates"])
    weights = [(to, _number(weight, f"the weight from {name} to {to}")) for to, weight in entry["to"].items()]
    whole = sum(weight for _, weight in weights)
    if any(weight < 0.0 for _, weight in weights) or whole <= 0.0:
        raise ValueError(f"the weights of the destinations of {name} must be 0 or more, and one of them more than 0")
    if any(to == name and weight > 0.0 for to, weight in weights):
        raise ValueError(f"persons at {name} cannot have {name} as their destination")
    return StopDemand(
        stop_id=name, rates=rates, destinations=tuple((to, weight / whole) for to, weight in weights if weight > 0.0)
    )


def _rate(name: str, entry: dict[str, Any]) -> Rate:
    per_hour = _number(entry["per_hour"], f"the rate at {name}")
    if not 0.0 <= per_hour <= MOST_PER_HOUR:
        raise ValueError(f"the rate at {name} is {per_hour:g} persons an hour; it must lie in [0, {MOST_PER_HOUR:g}]")
    from_s, to_s = _time(entry["from"], f"'from' at {name}"), _time(entry["to"], f"'to' at {name}")
    if to_s <= from_s:
        raise ValueError(f"a rate at {name} lasts from {entry['from']} to {entry['to']}, which is not later")
    return Rate(from_s=from_s, to_s=to_s, per_hour=per_hour)


def _connection(name: str, entry: dict[str, Any]) -> Connection:
    return Connection(
        name=str(entry["name"]),
        every_s=60.0 * _positive(entry["every_min"], f"every_min of the connection at {name}"),
        first_s=_time(entry["first"], f"'first' of the connection at {name}"),
        walk_s=60.0 * abs(_number(entry["walk_min"], f"walk_min of the connection at {name}")),
        share=_share(entry["share"], f"the share of the connection at {name}"),
    )


def _number(value: object, what: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f"{what} is {value!r}; it must be a finite number")
    return float(value)


def _positive(value: object, what: str) -> float:
    number = _number(value, what)
    if number <= 0.0:
        raise ValueError(f"{what} is {number:g}; it must be more than 0")
    return number


def _share(value: object, what: str) -> float:
    number = _number(value, what)
    if not 0.0 <= number <= 1.0:
        raise ValueError(f"{what} is {number:g}; it must lie in [0, 1]")
    return number


def _time(text: object, what: str) -> float:
    """``06:30`` as s from midnight; ``24:00`` is the end of the day."""
    hours, colon, minutes = str(text).partition(":")
    if not isinstance(text, str) or not colon or not (hours.isdecimal() and minutes.isdecimal()):
        raise ValueError(f"{what} is {text!r}; write a time of the day such as '06:30'")
    value = HOUR_S * int(hours) + 60.0 * int(minutes)
    if int(minutes) > 59 or value > 24.0 * HOUR_S:
        raise ValueError(f"{what} is {text!r}; write a time of the day such as '06:30'")
    return value
