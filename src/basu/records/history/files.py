"""Writes a record to its two files and reads it back: ``history.parquet`` (frames, events), ``route.json`` (facts).

Both are deterministic: no clock, no path and no order of hashes enters them.
"""

from __future__ import annotations

import io
import json
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from basu.errors import UserError
from basu.records.history.model import FRAME, OTHER, Collision, Facts, History, LaneInvasion, Vehicle
from basu.records.history.route_json import route_from_json, route_to_json
from basu.utils.atomic import write_bytes

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

HISTORY_FILE, FACTS_FILE = "history.parquet", "route.json"
FACTS_SCHEMA_VERSION = 2


def write_history(folder: Path, history: History) -> None:
    """Write both files into ``folder``, each at once or not at all.

    Raises:
        UserError: the disk is full or the folder cannot be written.
    """
    buffer = io.BytesIO()
    pq.write_table(_table(history), buffer, compression="zstd", store_schema=True)
    write_bytes(folder / HISTORY_FILE, buffer.getvalue())
    write_bytes(folder / FACTS_FILE, facts_to_json(history.facts).encode())


def read_history(folder: Path) -> History:
    """Read the record of a run folder.

    Raises:
        UserError: a file is missing or not what it should be.
    """
    try:
        table = pq.read_table(folder / HISTORY_FILE)
        facts = facts_from_json((folder / FACTS_FILE).read_text(encoding="utf-8"))
        return _history(table, facts)
    except OSError as error:
        raise UserError(f"{folder} is no run folder that can be scored: {error}") from error
    except (KeyError, ValueError, TypeError, pa.ArrowException) as error:
        raise UserError(f"{folder} holds a record that this version cannot read: {error}") from error


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
    document = json.loads(text)
    version = document["schema_version"]
    if version != FACTS_SCHEMA_VERSION:
        lacks = ", which lacks what the metrics ask for (lanes, lights, who drives)" if version == 1 else ""
        raise ValueError(
            f"{FACTS_FILE} has schema version {version}{lacks}, and this one reads {FACTS_SCHEMA_VERSION}; score it "
            "with the version of basu that its config.json names, or drive it again by the command there"
        )
    return Facts(
        step_s=document["step_s"],
        vehicle=Vehicle(**document["vehicle"]),
        actor_types={int(key): value for key, value in document["actor_types"].items()},
        actor_sizes={int(key): (half[0], half[1]) for key, half in document["actor_sizes"].items()},
        route=route_from_json(document["route"]),
    )


def _table(history: History) -> pa.Table:
    """One row a tick; what happens several times in a tick is a list in its row."""
    ticks = len(history.frames)
    columns = {name: pa.array(np.ascontiguousarray(history.frames[name])) for name in FRAME.names or ()}
    columns["others"] = _lists(_structs(history.others), history.others["tick"], ticks)
    contacts = pa.array(
        [
            {"other_id": c.other_id, "other_type": c.other_type, "impulse_ns": list(c.impulse_ns)}
            for c in history.collisions
        ],
        type=pa.struct(
            [("other_id", pa.uint32()), ("other_type", pa.string()), ("impulse_ns", pa.list_(pa.float64(), 3))]
        ),
    )
    columns["collisions"] = _lists(contacts, [c.tick for c in history.collisions], ticks)
    crossed = pa.array([list(e.markings) for e in history.lane_invasions], type=pa.list_(pa.string()))
    columns["lane_invasions"] = _lists(crossed, [e.tick for e in history.lane_invasions], ticks)
    return pa.table(columns)


def _structs(others: NDArray[np.void]) -> pa.StructArray:
    """The rows of OTHER without their tick, which the list they stand in tells."""
    names = [name for name in OTHER.names or () if name != "tick"]
    return pa.StructArray.from_arrays([pa.array(np.ascontiguousarray(others[name])) for name in names], names=names)


def _lists(values: pa.Array, tick_of_value: NDArray[np.int64] | list[int], ticks: int) -> pa.ListArray:
    """Values gathered into one list a tick; ``tick_of_value`` ascends."""
    counts = np.bincount(np.asarray(tick_of_value, dtype=np.int64), minlength=ticks)
    offsets = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
    return pa.ListArray.from_arrays(pa.array(offsets), values)


def _history(table: pa.Table, facts: Facts) -> History:
    """The record in a table of :func:`_table`."""
    frames = np.zeros(table.num_rows, dtype=FRAME)
    for name in FRAME.names or ():
        frames[name] = table[name].to_numpy()
    nearby = table["others"].combine_chunks()
    rows = nearby.flatten()
    others = np.zeros(len(rows), dtype=OTHER)
    others["tick"] = np.repeat(frames["tick"], nearby.value_lengths().to_numpy())
    for name in OTHER.names or ():
        if name != "tick":
            others[name] = rows.field(name).to_numpy()
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
