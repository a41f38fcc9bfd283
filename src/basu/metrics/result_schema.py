"""The JSON Schema of ``result.json``, generated from the registry of metrics.

``data/result.frame.json`` holds what is no metric: meta, scoring, scenarios, evidence. ``scripts/result_schema.py``
writes ``data/result.schema.json``, and a test holds the two against each other.
"""

from __future__ import annotations

import json
from typing import Any

from basu.metrics.json_schema import EVIDENCE, choice, flag, integer, listing, mapping, number, record, text
from basu.metrics.registry import built_in
from basu.metrics.responsibility import CollisionKind
from basu.metrics.result import SCHEMA_VERSION
from basu.outcome import Status
from basu.utils.packaged import PACKAGE_FOLDER

SCHEMA_FILE = PACKAGE_FOLDER / "data" / "result.schema.json"
FRAME_FILE = PACKAGE_FOLDER / "data" / "result.frame.json"


def result_schema() -> dict[str, Any]:
    """The schema: the frame with a property for each of BASU's metrics."""
    frame: dict[str, Any] = json.loads(FRAME_FILE.read_text(encoding="utf-8"))
    around = frame.pop("properties")
    definitions = frame.pop("$defs")
    definitions["evidence"]["properties"]["responsibility"] = record(
        about_="of a collision, by nuPlan's rule: docs/metrics.md",
        at_fault=flag(),
        kind=choice([kind.value for kind in CollisionKind]),
        sentence=text(),
    )
    own = record(
        about_="a user's metric",
        title=text(),
        unit=text(),
        digits=integer(low=0),
        value={"description": "as the metric computes it"},
        penalties=mapping(number(low=0, high=1), about="factors by kind; none for a metric that is only reported"),
        events=listing(EVIDENCE),
    )
    properties = {
        "schema_version": {"const": SCHEMA_VERSION},
        "status": choice([status.value for status in Status]),
        **{name: around[name] for name in ("fault", "message", "scores", "infractions")},
        **{metric.name: {**metric.schema, "title": metric.title} for metric in built_in()},
        "metrics": mapping(own, about="users' metrics by name"),
        **{name: around[name] for name in ("scoring", "scenarios", "meta")},
    }
    return {
        **{key: value for key, value in frame.items() if key != "additionalProperties"},
        "required": [name for name in properties if name != "scenarios"],
        "additionalProperties": False,
        "properties": properties,
        "$defs": definitions,
    }


def schema_text() -> str:
    """The schema as it stands in its file."""
    return json.dumps(result_schema(), indent=2, ensure_ascii=False) + "\n"
