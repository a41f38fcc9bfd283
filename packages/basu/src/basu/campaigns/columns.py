"""The columns of a campaign's table: ids and conditions, the verdict, scores, every metric of the registry, costs.

A metric's columns come from its JSON Schema. A number, a flag or a text is a column. A record has a column for each of
its values, by names joined with ``_``. A list has its length as ``NAME_number``, and for each flag of its items the
number of items with that flag. What has free keys has no column.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pyarrow as pa

from basu.jobs.job import versions
from basu.metrics.infraction import Infraction
from basu.metrics.registry import built_in, user_metrics
from basu.output.report.drive_row import row_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from basu.metrics.json_schema import Schema
    from basu.metrics.registry import Metric
    from basu.metrics.result import Result

VOLATILE = ("host", "worker", "wall_s", "cpu_s", "memory_mb", "attempts")
"""Columns that differ between two runs of one campaign; all others are the same."""

IDS = {
    "number": pa.int64(),  # of the job, from 0
    "id": pa.string(),  # the same in every campaign that has this job
    "agent": pa.string(),
    "track": pa.string(),  # what it learned of others
    "kind": pa.string(),  # route or case
    "subject": pa.string(),  # the route's id, or the case's
    "identity": pa.string(),  # the case's id with its variation, for `basu scenario run`
    "town": pa.string(),
    "weather": pa.string(),
    "vehicles": pa.int64(),
    "walkers": pa.int64(),
    "density_per_km": pa.float64(),
    "seed": pa.int64(),
}
VERDICT = {
    "status": pa.string(),
    "fault": pa.string(),
    "judged": pa.bool_(),  # whether the drive says something of the agent
    "success": pa.bool_(),  # null where it is not judged
    "not_exercised": pa.int64(),  # scenarios without their conflict; they count for neither side
    "message": pa.string(),
    "severity": pa.float64(),  # 0 (good) to 1 (bad), for a ranking
    "completed": pa.bool_(),  # of a case; null on a route, and where the policy has no answer
    "impact_mps": pa.float64(),  # relative speed of the fastest collision of a case; null without one
    "scenario": pa.string(),  # class of a case; null on a route
    "group": pa.string(),
    "pre_crash": pa.string(),  # numbers of pre-crash scenarios that a user's class declares, with spaces
    "partner": pa.string(),
}
SCORES = {name: pa.float64() for name in ("driving_score", "infraction_score", "path_score")}
MARGINS = {f"margin_{name}": pa.float64() for name in ("distance_m", "ttc_s", "pet_s")}
COSTS = {
    "simulated_s": pa.float64(),
    "wall_s": pa.float64(),
    "cpu_s": pa.float64(),  # of the worker with its simulator and agent
    "memory_mb": pa.float64(),  # likewise, at the end of the drive
    "records_bytes": pa.int64(),  # of the record's folder
    "attempts": pa.int64(),
    "host": pa.string(),
    "worker": pa.int64(),  # process id
    "version_basu": pa.string(),
    "version_carla": pa.string(),
    "version_python": pa.string(),
}
TYPES = {"number": pa.float64(), "integer": pa.int64(), "boolean": pa.bool_(), "string": pa.string()}


def schema_of(parameters: Mapping[str, type], metric_files: Sequence[Path] = ()) -> pa.Schema:
    """The columns of a campaign with these parameters.

    Raises:
        UserError: a file of metrics cannot be used.
    """
    found: dict[str, pa.DataType] = {**IDS}
    found |= {f"parameter_{name}": pa.string() if kind is str else pa.float64() for name, kind in parameters.items()}
    found |= {**VERDICT, **SCORES, **MARGINS}
    found |= {f"infractions_{kind.value}": pa.int64() for kind in Infraction}
    for metric in built_in():
        found |= dict(_columns(metric.name, metric.schema))
    for metric in user_metrics(metric_files):
        found |= dict(_columns(f"own_{metric.name}", metric.schema))
    found |= COSTS
    return pa.schema([pa.field(name, kind) for name, kind in found.items()])


def columns_of(result: Result, own: Sequence[Metric] = ()) -> dict[str, Any]:
    """Return the columns of a drive that follow from its result; one that is not among them is null.

    ``own`` are users' metrics.
    """
    row = row_of(result)
    values = {name: row[name] for name in ("status", "fault", "message", "severity", "not_exercised", "simulated_s")}
    values |= {"judged": row["passed"] is not None, "success": row["passed"]}
    values |= {f"margin_{name}": value for name, value in row["margins"].items()}
    values |= {f"version_{name}": text for name, text in versions().items()}
    if result.case is not None:
        values |= _of_case(result.case)
    if result.scores is not None:
        scores = result.scores
        values |= {
            "driving_score": scores.driving,
            "infraction_score": scores.infraction,
            "path_score": scores.path_following,
        }
        values |= {f"infractions_{kind.value}": row["infractions"].get(kind.value, 0) for kind in Infraction}
        for metric in built_in():
            values |= dict(_values(metric.name, metric.schema, row["metrics"].get(metric.name)))
        for metric in own:
            values |= dict(_values(f"own_{metric.name}", metric.schema, row["own"].get(metric.name)))
    return values


def _of_case(case: Mapping[str, Any]) -> dict[str, Any]:
    """Return the columns of a case that its risk for a million miles needs."""
    assessment = case["assessment"]
    return {
        "completed": None if assessment is None else assessment["completed"]["holds"],
        "impact_mps": max((hit["speed_mps"] for hit in case["collisions"]), default=None),
        "scenario": case["scenario"],
        "group": case["group"],
        "pre_crash": " ".join(str(number) for number in case["pre_crash"]),
        "partner": case["characteristics"]["partner"],
    }


def _kind(schema: Schema) -> str:
    """The type of a schema without null."""
    named = schema.get("type", "string" if "enum" in schema else "")
    names = [named] if isinstance(named, str) else [name for name in named if name != "null"]
    return str(names[0]) if names else ""


def _flags(schema: Schema) -> list[str]:
    """The names of the flags of a list's items."""
    properties = schema.get("items", {}).get("properties", {})
    return [name for name, each in properties.items() if _kind(each) == "boolean"]


def _columns(name: str, schema: Schema) -> Iterator[tuple[str, pa.DataType]]:
    """The columns of a value."""
    kind = _kind(schema)
    if kind in TYPES:
        yield name, TYPES[kind]
    elif kind == "array":
        yield f"{name}_number", pa.int64()
        yield from ((f"{name}_{flag}", pa.int64()) for flag in _flags(schema))
    for key, each in schema.get("properties", {}).items():
        yield from _columns(f"{name}_{key}", each)


def _values(name: str, schema: Schema, value: Any) -> Iterator[tuple[str, Any]]:  # noqa: ANN401 - as its schema says
    """The values of the columns."""
    kind = _kind(schema)
    if value is None:
        return
    if kind in TYPES:
        yield name, float(value) if kind == "number" else value
    elif kind == "array":
        yield f"{name}_number", len(value)
        for flag in _flags(schema):
            yield f"{name}_{flag}", sum(bool(item.get(flag)) for item in value)
    for key, each in schema.get("properties", {}).items():
        yield from _values(f"{name}_{key}", each, value.get(key))
