"""Writes a record to its files and reads it back: ``history.parquet`` (frames, events), ``route.json`` (facts).

A run amid SUMO's traffic has ``sumo.json`` as well. All are deterministic: no clock, no path and no order of hashes
enters them.
"""

from __future__ import annotations

import io
import json
import math
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from basu.errors import UserError
from basu.files import loads, write_bytes
from basu.records.history.facts_document import check_facts
from basu.records.history.model import FRAME, OTHER, Collision, Facts, History, LaneInvasion, Vehicle
from basu.records.history.sumo import read_sumo, write_sumo
from basu.records.history.tables import to_arrow
from basu.routing import ControlKind, Route, RouteControl, Stop
from basu.routing.timetable import timetable_from_json, timetable_to_json

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray


ARRAYS = ("points_m", "s_m", "yaw_rad", "lane_width_m", "speed_limit_mps", "is_junction", "road_id", "lane_id")


def route_to_json(route: Route) -> dict[str, Any]:
    """The route without its client handles; a limit that is not posted (nan) becomes null."""
    document: dict[str, Any] = {"id": route.id, "town": route.town}
    for name in ARRAYS:
        document[name] = getattr(route, name).tolist()
    document["speed_limit_mps"] = [None if math.isnan(limit) else limit for limit in document["speed_limit_mps"]]
    document["stops"] = [asdict(stop) for stop in route.stops]
    if route.timetable is not None:
        document["timetable"] = timetable_to_json(route.timetable)
    document["controls"] = [{**asdict(control), "kind": control.kind.value} for control in route.controls]
    return document


def route_from_json(document: dict[str, Any]) -> Route:
    """Read what :func:`route_to_json` wrote."""
    limits = [math.nan if limit is None else limit for limit in document["speed_limit_mps"]]
    arrays: dict[str, Any] = {name: np.array(document[name]) for name in ARRAYS if name != "speed_limit_mps"}
    return Route(
        id=document["id"],
        town=document["town"],
        speed_limit_mps=np.array(limits, dtype=np.float64),
        stops=tuple(Stop(**stop) for stop in document["stops"]),
        timetable=timetable_from_json(document["timetable"]) if "timetable" in document else None,
        controls=tuple(RouteControl(**{**c, "kind": ControlKind(c["kind"])}) for c in document["controls"]),
        **arrays,
    )


HISTORY_FILE, FACTS_FILE = "history.parquet", "route.json"
FACTS_SCHEMA_VERSION = 3
WITHOUT_APPLIED = 2  # its records hold the requested control alone, which is read as the applied one too


def write_history(folder: Path, history: History) -> None:
    """Write the files into ``folder``, each at once or not at all.

    Raises:
        UserError: the disk is full or the folder cannot be written.
    """
    buffer = io.BytesIO()
    pq.write_table(to_arrow(history), buffer, compression="zstd", store_schema=True)
    write_bytes(folder / HISTORY_FILE, buffer.getvalue())
    write_bytes(folder / FACTS_FILE, facts_to_json(history.facts).encode())
    if history.sumo is not None:
        write_sumo(folder, history.sumo)


def read_history(folder: Path) -> History:
    """Read the record of a run folder.

    Raises:
        UserError: a file is missing or not what it should be.
    """
    try:
        table = pq.read_table(folder / HISTORY_FILE)
        facts = facts_from_json((folder / FACTS_FILE).read_text(encoding="utf-8"))
        return replace(_history(table, facts), sumo=read_sumo(folder))
    except OSError as error:
        raise UserError(f"{folder} is no run folder that can be scored: {error}") from error
    except (KeyError, ValueError, TypeError, pa.ArrowException) as error:
        raise UserError(f"{folder} holds a record that this version cannot read: {error}") from error


def lacks(folder: Path) -> str | None:
    """A sentence about what the record of a run folder does not hold, since an earlier version wrote it; else None."""
    version = json.loads((folder / FACTS_FILE).read_text(encoding="utf-8"))["schema_version"]
    if version != WITHOUT_APPLIED:
        return None
    return (
        f"the record of {folder} has schema version {version}: it holds neither standing things nor the applied "
        "control, so a stop for a thing reads as a phantom stop; drive the run again for a full judgement"
    )


def facts_to_json(facts: Facts) -> str:
    """The facts as JSON text; floats as Python writes them, so they read back exactly."""
    vehicle = facts.vehicle
    return json.dumps(
        {
            "schema_version": FACTS_SCHEMA_VERSION,
            "step_s": facts.step_s,
            "vehicle": {
                "type_id": vehicle.type_id,
                "front_m": vehicle.front_m,
                "rear_m": vehicle.rear_m,
                "width_m": vehicle.width_m,
            },
            "actor_types": {str(key): facts.actor_types[key] for key in sorted(facts.actor_types)},
            "actor_sizes": {str(key): list(facts.actor_sizes[key]) for key in sorted(facts.actor_sizes)},
            "route": route_to_json(facts.route),
        }
    )


def facts_from_json(text: str) -> Facts:
    """Read what :func:`facts_to_json` wrote."""
    document = loads(text)
    version = document["schema_version"]
    if version not in (WITHOUT_APPLIED, FACTS_SCHEMA_VERSION):
        lacks = ", which lacks what the metrics ask for (lanes, lights, the driver)" if version == 1 else ""
        raise ValueError(
            f"{FACTS_FILE} has schema version {version}{lacks}, and this one reads {FACTS_SCHEMA_VERSION}; score it "
            "with the version of basu that its config.json names, or drive it again by the command there"
        )
    check_facts(document)
    return Facts(
        step_s=document["step_s"],
        vehicle=Vehicle(**document["vehicle"]),
        actor_types={int(key): value for key, value in document["actor_types"].items()},
        actor_sizes={int(key): (half[0], half[1]) for key, half in document["actor_sizes"].items()},
        route=route_from_json(document["route"]),
    )


MAY_BE_NAN = frozenset({"lane_offset_m", "lane_heading_rad", "lane_width_m", "off_lane_m"})  # where there is no lane


def _check_frames(frames: NDArray[np.void]) -> None:
    """Check that frames are consecutive and finite.

    Raises:
        ValueError: they are not.
    """
    if not len(frames):
        raise ValueError(f"{HISTORY_FILE} has no frame")
    if not np.array_equal(frames["tick"], np.arange(len(frames))):
        raise ValueError(f"the ticks of {HISTORY_FILE} do not count from 0 by 1")
    for name in frames.dtype.names or ():
        if name not in MAY_BE_NAN and not np.all(np.isfinite(frames[name])):
            raise ValueError(f"{name} in {HISTORY_FILE} has a value that is no number")


def _history(table: pa.Table, facts: Facts) -> History:
    """The record in a table of :func:`~basu.records.history.tables.to_arrow`."""
    frames = np.zeros(table.num_rows, dtype=FRAME)
    for name in FRAME.names or ():
        kept = name if name in table.column_names else name.removeprefix("applied_")
        frames[name] = table[kept].to_numpy()
    for name in ("others", "collisions", "lane_invasions"):
        if not pa.types.is_list(table[name].type):
            raise ValueError(f"{name} in {HISTORY_FILE} holds no lists")
    nearby = table["others"].combine_chunks()
    rows = nearby.flatten()
    others = np.zeros(len(rows), dtype=OTHER)
    others["tick"] = np.repeat(frames["tick"], nearby.value_lengths().to_numpy())
    for name in OTHER.names or ():
        if name != "tick":
            others[name] = rows.field(name).to_numpy()
    _check_frames(frames)
    contacts = zip(frames["tick"].tolist(), table["collisions"].to_pylist(), strict=True)
    crossings = zip(frames["tick"].tolist(), table["lane_invasions"].to_pylist(), strict=True)
    return History(
        facts=facts,
        frames=frames,
        others=others,
        collisions=tuple(
            Collision(tick=tick, other_id=c["other_id"], other_type=c["other_type"], impulse_ns=tuple(c["impulse_ns"]))
            for tick, events in contacts
            for c in events
        ),
        lane_invasions=tuple(
            LaneInvasion(tick=tick, markings=tuple(markings)) for tick, events in crossings for markings in events
        ),
    )
