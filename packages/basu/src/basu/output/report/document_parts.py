"""The documents of many drives as typed dicts: ``series.json`` and ``matrix.json``, from which their schemas follow."""

from __future__ import annotations

import json
from typing import Annotated, Any

from typing_extensions import NotRequired, TypedDict

from basu.conditions import Track
from basu.metrics.json_schema import Value, closed, schema_of
from basu.metrics.result import result_schema
from basu.metrics.result_parts import (
    Amount,
    AssessmentPart,
    CollisionPart,
    Count,
    FaultName,
    MarginsPart,
    ParameterPart,
    PreCrash,
    Share,
    VerdictName,
)

SERIES_SCHEMA_VERSION, MATRIX_SCHEMA_VERSION = 1, 2
Positive = Annotated[int, Value(low=1)]


@closed
class SpreadPart(TypedDict):
    """Mean, standard deviation and extremes."""

    mean: float
    deviation: Amount
    lowest: float
    highest: float


@closed
class SeriesRow(TypedDict):
    """What a series keeps of a run."""

    number: Count
    route: str
    repetition: Count
    seed: int
    folder: str
    status: str
    fault: Annotated[
        FaultName, "a run that another than the agent ended stands here only if its record was unsafe before"
    ]
    passed: NotRequired[Annotated[bool | None, "by the one rule of success; null says nothing of it"]]
    own_route: NotRequired[Annotated[bool, "the route was the agent's own: its score is not comparable"]]
    scores: dict[str, Share] | None
    leaderboard: dict[str, dict[str, Any]]
    infractions: dict[str, Positive]
    driven_m: Amount
    planned_m: Amount | None
    simulated_s: Amount
    wall_s: Amount
    track: NotRequired[Annotated[str, "marked where no gate stood before the agent; empty where it is not known"]]


@closed
class SetAsidePart(TypedDict):
    """A run that does not count."""

    folder: str
    status: str


@closed
class RatePart(TypedDict):
    """How often a kind of infraction happened."""

    number: Positive
    per_km: Amount | None


@closed
class TotalsPart(TypedDict):
    """The totals of a series."""

    done: Count
    planned: Positive
    scores: dict[str, SpreadPart]
    leaderboard: dict[str, dict[str, SpreadPart]]
    passed: NotRequired[
        Annotated[dict[str, Count], "how many runs passed, failed and were not judged, by the one rule of success"]
    ]
    statuses: dict[str, Positive]
    infractions: dict[str, RatePart]
    driven_km: Amount
    simulated_s: Amount
    wall_s: Amount


@closed
class SeriesDocument(TypedDict):
    """``series.json`` without its version."""

    options: Annotated[dict[str, Any], "all that the results depend on; what differs is refused by --resume"]
    planned: Positive
    runs: Annotated[list[SeriesRow], "the runs that are done, by number"]
    set_aside: Annotated[
        list[SetAsidePart],
        "runs that ended for no fault of the agent's; driven again by --resume and never counted",
    ]
    totals: TotalsPart


class CaseAccessPart(TypedDict):
    """The agent's access to the simulator."""

    track: Track
    open: bool


class CellPart(TypedDict):
    """A case with an agent."""

    verdict: VerdictName
    fault: FaultName
    status: NotRequired[Annotated[str, "how the drive ended"]]
    message: str
    assessment: Annotated[AssessmentPart | None, "the answers of the policy; null where nothing was recorded"]
    collisions: list[CollisionPart]
    margins: Annotated[MarginsPart, "how narrowly, least of all; null where no actor came near"]
    simulated_s: NotRequired[Amount]
    wall_s: Amount
    access: NotRequired[
        Annotated[CaseAccessPart, "the agent's access to the simulator; absent where nothing was driven"]
    ]
    folder: Annotated[str, "beside this file; empty where nothing was left"]


class MatrixRow(TypedDict):
    """A case with all agents."""

    id: Annotated[str, "of the case, by which it can be played alone"]
    repetition: NotRequired[Annotated[int, Value("absent where each case was driven once", low=0)]]
    scenario: Annotated[str, "the class"]
    title: Annotated[str, "what happens, a line"]
    group: Annotated[str, "of NHTSA's pre-crash typology, or shuttle"]
    place: Annotated[str, "where, in words"]
    on_route: Annotated[bool, "whether on the shuttle's way"]
    characteristics: Annotated[dict[str, str], "after table 3.1 of the thesis, as --where takes them"]
    pre_crash: PreCrash
    parameters: list[ParameterPart]
    results: Annotated[dict[str, CellPart], "by agent"]


class EstimatePart(TypedDict):
    """A share with its interval of 95 %."""

    share: Share
    low: Share
    high: Share


Estimated = Annotated[EstimatePart | None, "a share with its interval of 95 %; null where nothing was exercised"]


class BurdenPart(TypedDict):
    """The burden of a group of crashes."""

    fatal_crashes: Amount
    crashes: Amount
    cost_musd: Amount
    equivalent_lives: Amount


class GroupSharePart(TypedDict):
    """The share of a group of the typology."""

    group: str
    passed: Estimated
    shown: Estimated
    scenarios: Count
    cases: Count
    not_exercised: Count
    burden: Annotated[
        BurdenPart | None, "of a year, table 1.1 of the thesis; null where the group is not in the typology"
    ]


class SharePart(TypedDict):
    """What an agent's passed cases stand for."""

    share_of_cost: Estimated
    share_of_crashes: Estimated
    share_of_fatal_crashes: Estimated
    share_of_equivalent_lives: Estimated
    shown_of_cost: Estimated
    cases: NotRequired[Annotated[int, Value("of the suite", low=0)]]
    judged: NotRequired[Annotated[int, Value("cases that were passed or failed", low=0)]]
    measured_of_cost: Annotated[Share, "the exercised groups' part of all cost"]
    groups: list[GroupSharePart]
    unmeasured: list[str]
    not_exercised: Count
    collisions: Count
    at_fault: Annotated[int, Value("collisions for which the agent is at fault", low=0)]
    assumptions: list[str]


class MatrixDocument(TypedDict):
    """``matrix.json`` without its version."""

    started: str
    what: Annotated[str, "the requested cases"]
    agents: list[str]
    sweep: Annotated[dict[str, Any] | None, "how parameters were sampled: n and seed, or grid; and which vary"]
    wall_s: Amount
    workers: Positive
    cases: list[MatrixRow]
    shares: Annotated[dict[str, SharePart], "by agent"]
    versions: dict[str, str]


def series_schema() -> dict[str, Any]:
    """Return the schema of ``series.json``."""
    title = "series.json: many runs of one command, their totals, and what they depend on"
    return _schema(SeriesDocument, SERIES_SCHEMA_VERSION, title)


def matrix_schema() -> dict[str, Any]:
    """Return the schema of ``matrix.json``."""
    return _schema(
        MatrixDocument, MATRIX_SCHEMA_VERSION, "matrix.json: cases with agents, and what the passed ones stand for"
    )


def _schema(kind: Any, version: int, title: str) -> dict[str, Any]:  # noqa: ANN401 - a typed dict
    """Return the schema of a document with its version."""
    found = schema_of(kind)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": title,
        **found,
        "required": ["schema_version", *found["required"]],
        "properties": {"schema_version": {"const": version}, **found["properties"]},
    }


SCHEMAS = {
    "result.schema.json": result_schema,
    "series.schema.json": series_schema,
    "matrix.schema.json": matrix_schema,
}


def schema_text(name: str) -> str:
    """Return a schema as it stands in its file."""
    return json.dumps(SCHEMAS[name](), indent=2, ensure_ascii=False) + "\n"
