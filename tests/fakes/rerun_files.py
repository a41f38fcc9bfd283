"""What stands in a recording of Rerun's, read back chunk by chunk."""

from pathlib import Path
from typing import Any, NamedTuple

from rerun.chunk import RrdReader


class Logged(NamedTuple):
    """One value: when (s, None where it holds for all time) and what, by component."""

    t_s: float | None
    values: dict[str, Any]


def read_rrd(path: Path) -> dict[str, list[Logged]]:
    """Everything in a recording by entity, in the order of time."""
    found: dict[str, list[Logged]] = {}
    for chunk in RrdReader(str(path)).stream():
        rows = found.setdefault(chunk.entity_path, [])
        for row in chunk.to_record_batch().to_pylist():
            time = row.pop("simulated_time", None)
            values = {name: value for name, value in row.items() if ":" in name}
            rows.append(Logged(None if time is None else time.total_seconds(), values))
    return {name: sorted(rows, key=lambda row: row.t_s or 0.0) for name, rows in found.items()}


def timelines(path: Path) -> set[str]:
    """The timelines of a recording."""
    return {name for chunk in RrdReader(str(path)).stream() for name in chunk.timeline_names}
