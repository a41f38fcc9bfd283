"""The record of a run as Arrow tables and pandas' data frames, with the unit of each column."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

from basu.errors import UserError
from basu.records.history.model import FRAME, OTHER
from basu.records.structured import StructuredArray
from basu.units import parted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from basu.records.history.model import History

TABLES = ("frames", "others", "collisions", "lane_invasions")


def to_arrow(history: History) -> pa.Table:
    """One row a tick, the unit of each column in its field's metadata; events and others are lists in their row."""
    ticks = len(history.frames)
    columns = {name: _numbers(history.frames[name]) for name in FRAME.names or ()}
    columns["others"] = _lists(_structs(history.others), history.others["tick"], ticks)
    contacts = _contacts(history)
    columns["collisions"] = _lists(contacts, [c.tick for c in history.collisions], ticks)
    crossed = _lists_of(
        _texts([marking for event in history.lane_invasions for marking in event.markings]),
        [len(event.markings) for event in history.lane_invasions],
    )
    columns["lane_invasions"] = _lists(crossed, [e.tick for e in history.lane_invasions], ticks)
    fields = [_field(name, column.type) for name, column in columns.items()]
    return pa.Table.from_arrays(list(columns.values()), schema=pa.schema(fields))


def to_pandas(history: History, what: str = "frames") -> Any:  # noqa: ANN401 - a DataFrame; pandas is optional
    """A data frame with its units in ``attrs["units"]``: the frames, or one of the other `TABLES`.

    Raises:
        UserError: there is no such table, or pandas is not installed.
    """
    if what not in TABLES:
        raise UserError(f"a record has no table '{what}'; there are {', '.join(TABLES)}")
    try:
        import pandas as pd  # noqa: PLC0415 - optional
    except ImportError as error:
        raise UserError("pandas is not installed; install it, or use to_arrow()") from error
    rows: Any
    if what == "frames":
        rows = {name: history.frames[name] for name in FRAME.names or ()}
    elif what == "others":
        rows = {name: history.others[name] for name in OTHER.names or ()}
        rows["type"] = [history.facts.actor_types.get(int(key), "") for key in history.others["id"]]
    elif what == "collisions":
        rows = _collisions(history)
    else:
        rows = [{"tick": e.tick, "marking": marking} for e in history.lane_invasions for marking in e.markings]
    table = pd.DataFrame(rows)
    table.attrs["units"] = {str(name): parted(str(name))[1] for name in table.columns}
    return table


def _collisions(history: History) -> dict[str, Any]:
    """The messages of the collision sensor as columns."""
    impulse_ns = np.array([c.impulse_ns for c in history.collisions], dtype=np.float64).reshape(-1, 3)
    return {
        "tick": [c.tick for c in history.collisions],
        "other_id": [c.other_id for c in history.collisions],
        "other_type": [c.other_type for c in history.collisions],
        **{f"impulse_{axis}_ns": impulse_ns[:, index] for index, axis in enumerate("xyz")},
    }


def _field(name: str, kind: pa.DataType) -> pa.Field:
    """A column with its unit."""
    unit = parted(name)[1]
    return pa.field(name, kind, metadata={"unit": unit} if unit else None)


def _structs(others: StructuredArray) -> pa.StructArray:
    """The rows of OTHER without their tick, which the list they stand in tells."""
    names = [name for name in OTHER.names or () if name != "tick"]
    arrays = [_numbers(others[name]) for name in names]
    return pa.StructArray.from_arrays(
        arrays, fields=[_field(name, array.type) for name, array in zip(names, arrays, strict=True)]
    )


def _contacts(history: History) -> pa.StructArray:
    """The messages of the collision sensor."""
    contacts = history.collisions
    impulses_ns = np.array([contact.impulse_ns for contact in contacts], dtype=np.float64).ravel()
    return pa.StructArray.from_arrays(
        [
            _numbers(np.array([contact.other_id for contact in contacts], dtype=np.uint32)),
            _texts([contact.other_type for contact in contacts]),
            pa.FixedSizeListArray.from_arrays(_numbers(impulses_ns), 3),
        ],
        names=["other_id", "other_type", "impulse_ns"],
    )


def _numbers(values: NDArray[Any]) -> pa.Array:
    """A column of numbers, (N,). ``pa.array`` imports pandas where it is installed, which takes half a second."""
    buffer = pa.py_buffer(np.ascontiguousarray(values))
    return pa.Array.from_buffers(pa.from_numpy_dtype(values.dtype), len(values), [None, buffer])


def _texts(values: Sequence[str]) -> pa.Array:
    """A column of texts; as in ``_numbers``, without ``pa.array``."""
    encoded = [value.encode() for value in values]
    offsets = np.cumsum([0, *map(len, encoded)], dtype=np.int32)
    return pa.Array.from_buffers(
        pa.string(), len(encoded), [None, pa.py_buffer(offsets), pa.py_buffer(b"".join(encoded))]
    )


def _lists(values: pa.Array, tick_of_value: NDArray[np.int64] | list[int], ticks: int) -> pa.ListArray:
    """Values gathered into one list a tick; ``tick_of_value`` ascends."""
    return _lists_of(values, np.bincount(np.asarray(tick_of_value, dtype=np.int64), minlength=ticks))


def _lists_of(values: pa.Array, lengths: NDArray[np.int64] | list[int]) -> pa.ListArray:
    """Values gathered into lists of these lengths."""
    offsets = np.concatenate([[0], np.cumsum(lengths)]).astype(np.int32)
    return pa.ListArray.from_arrays(_numbers(offsets), values)
