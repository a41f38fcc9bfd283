"""The persons of a service, drawn from a demand and a seed; each stop has a random stream of its own.

Persons come as a Poisson process with the rates of the file. Arrivals and attributes depend on demand, seed and times
alone. So two services with one seed have the same persons, whatever the vehicles do, and can be compared in pairs.
"""

from __future__ import annotations

import enum
import zlib
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from basu_service.demand import Demand, Shares, StopDemand

PATIENCE_SPREAD = 0.5
"""A person's patience is uniform between 0.5 and 1.5 of the mean: an assumption of this project."""


class Kind(enum.Enum):
    """How a person moves; it decides about time at the door and space."""

    ON_FOOT = "on_foot"
    WHEELCHAIR = "wheelchair"
    PUSHCHAIR = "pushchair"


@dataclass(frozen=True, slots=True, kw_only=True)
class Person:
    """A person that comes to a stop; times in s from the beginning of the service."""

    number: int  # in the order of coming
    stop_id: str
    destination_id: str
    came_s: float
    patience_s: float  # after this time without boarding the person gives up
    kind: Kind
    needs_seat: bool
    likes_standing: bool
    holds_on: bool  # while standing
    steadiness: float  # quantile in (0, 1) of the acceleration at which the person loses balance
    connects: bool  # goes on with the connection at the destination, if there is one


def draw_persons(demand: Demand, seed: int, begins_s: float, lasts_s: float) -> tuple[Person, ...]:
    """Return all persons of a service that begins at ``begins_s`` from midnight, in the order of coming."""
    drawn = [
        (came_s, stop, rng)
        for stop in demand.stops
        for rng in [np.random.default_rng([seed, zlib.crc32(stop.stop_id.encode())])]
        for came_s in list(_arrivals_s(stop, rng, begins_s, lasts_s))
    ]
    made = [_person(demand, stop, came_s, rng) for came_s, stop, rng in drawn]
    made.sort(key=lambda person: (person.came_s, person.stop_id))
    return tuple(_numbered(person, number) for number, person in enumerate(made))


def _numbered(person: Person, number: int) -> Person:
    values = {name: getattr(person, name) for name in Person.__dataclass_fields__}
    return Person(**{**values, "number": number})


def _arrivals_s(stop: StopDemand, rng: np.random.Generator, begins_s: float, lasts_s: float) -> Iterator[float]:
    """Yield the times of coming: exponential gaps within each stretch of the day."""
    for rate in stop.rates:
        at_s, end_s = max(rate.from_s, begins_s), min(rate.to_s, begins_s + lasts_s)
        while rate.per_hour > 0.0 and at_s < end_s:
            at_s += float(rng.exponential(3600.0 / rate.per_hour))
            if at_s < end_s:
                yield at_s - begins_s


def _person(demand: Demand, stop: StopDemand, came_s: float, rng: np.random.Generator) -> Person:
    """Return one person; each has the same number of draws, whatever comes of them."""
    where, patience, moves, sits, holds, steadiness, goes_on = rng.random(7)
    destination_id = _chosen(stop, float(where))
    connection, shares = demand.connections.get(destination_id), demand.shares
    kind = _kind(shares, float(moves))
    return Person(
        number=0,
        stop_id=stop.stop_id,
        destination_id=destination_id,
        came_s=came_s,
        patience_s=demand.patience_s * (1.0 + PATIENCE_SPREAD * (2.0 * float(patience) - 1.0)),
        kind=kind,
        needs_seat=kind is Kind.ON_FOOT and sits < shares.needs_seat,
        likes_standing=kind is Kind.ON_FOOT and sits >= 1.0 - shares.stands,
        holds_on=bool(holds < shares.holds_on),
        steadiness=min(max(float(steadiness), 1e-9), 1.0 - 1e-9),
        connects=connection is not None and bool(goes_on < connection.share),
    )


def _kind(shares: Shares, draw: float) -> Kind:
    if draw < shares.wheelchair:
        return Kind.WHEELCHAIR
    return Kind.PUSHCHAIR if draw < shares.wheelchair + shares.pushchair else Kind.ON_FOOT


def _chosen(stop: StopDemand, draw: float) -> str:
    """Return the destination at a quantile of the shares."""
    reached = 0.0
    for name, share in stop.destinations:
        reached += share
        if draw < reached:
            return name
    return stop.destinations[-1][0]
