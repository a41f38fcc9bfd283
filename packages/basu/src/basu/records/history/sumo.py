"""SUMO's part of a record: its traffic each second, and the passengers of the vehicle under test; ``sumo.json``."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.errors import UserError
from basu.files import other_version, read_json, write_bytes

if TYPE_CHECKING:
    from pathlib import Path

SUMO_FILE = "sumo.json"
SCHEMA_VERSION = 1


class Second(NamedTuple):
    """SUMO's own traffic in one second, the vehicle under test left out."""

    t_s: float
    vehicles: int
    people: int  # on foot
    halted: int  # vehicles below 0.1 m/s
    driven_m: float  # by all vehicles together
    lost_s: float  # by all together: SUMO's time loss, the time that slower driving than allowed has cost


class Passenger(NamedTuple):
    """A person that wanted to ride with the vehicle under test; times in s from the run's beginning."""

    name: str
    stop_id: str
    destination_id: str
    came_s: float
    boarded_s: float | None = None
    alighted_s: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SumoRecord:
    """What SUMO's traffic was in a run."""

    departed: int  # vehicles
    arrived: int
    delayed: int  # vehicles that found no room on the road to depart, at the end
    hidden: int  # road users that found no room in the simulator to be shown, at the end
    people: int  # persons that have set out
    contacts: int  # collisions of vehicles with each other that SUMO has seen
    seconds: tuple[Second, ...]
    passengers: tuple[Passenger, ...]


def write_sumo(folder: Path, record: SumoRecord) -> None:
    """Write the record into a run's folder.

    Raises:
        UserError: the disk is full or the folder cannot be written.
    """
    document = {"schema_version": SCHEMA_VERSION, **asdict(record)}
    document["columns"] = {"seconds": list(Second._fields), "passengers": list(Passenger._fields)}
    write_bytes(folder / SUMO_FILE, json.dumps(document).encode())


def read_sumo(folder: Path) -> SumoRecord | None:
    """Read the record of a run's folder; None for a run without SUMO.

    Raises:
        UserError: the file is not what it should be.
    """
    path = folder / SUMO_FILE
    if not path.exists():
        return None
    document: Any = read_json(path, "SUMO's record")
    try:
        if document["schema_version"] != SCHEMA_VERSION:
            raise other_version(path, document["schema_version"], SCHEMA_VERSION)
        numbers = {name: int(document[name]) for name in _NUMBERS}
        return SumoRecord(
            **numbers,
            seconds=tuple(Second(*row) for row in document["seconds"]),
            passengers=tuple(Passenger(*row) for row in document["passengers"]),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise UserError(f"{path} holds a record that this version cannot read: {error!r}") from error


_NUMBERS = ("departed", "arrived", "delayed", "hidden", "people", "contacts")
