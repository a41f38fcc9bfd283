"""The result of a drive, on a route or in a case, which `judge` makes, and the JSON Schema of ``result.json``.

`Result.document` is ``result.json``, and `Result.from_document` reads it back. Report, console, comparisons and tables
read the object. It is computed from the record alone.

The module `basu.metrics.result_parts` has the types of what is no metric, such as meta, scoring and the case.
The script ``scripts/result_schema.py`` writes ``data/result.schema.json``, and a test holds the two against each other.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Annotated, Any

from basu.metrics.collisions import responsibilities
from basu.metrics.display import Display, is_number, shown
from basu.metrics.infraction import (
    CollisionKind,
    Evidence,
    Incident,
    Infraction,
    OwnKind,
    Responsibility,
    counts,
    row_of,
)
from basu.metrics.json_schema import EVIDENCE, choice, flag, integer, listing, mapping, number, record, schema_of, text
from basu.metrics.path_following import path_following
from basu.metrics.registry import Drive, Metric, built_in
from basu.metrics.result_parts import CasePart, EvidencePart, FaultName, MetaPart, ScenarioPart, ScoresPart, ScoringPart
from basu.metrics.score import Scores, driving_score, in_order, infraction_score
from basu.metrics.scoring import Scoring, scoring_to_json
from basu.metrics.success import NOT_JUDGED, Success, success
from basu.outcome import Outcome, Status

if TYPE_CHECKING:
    from basu.metrics.display import JudgedRun
    from basu.records.history import History


SCHEMA_VERSION = 3
LATER = frozenset(
    {"scenarios", "case", "passed", "reasons", "careful_drivers"}
)  # absent where there is nothing, or from an earlier version


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnMetric(Display):
    """The value of a user's metric with what is needed to show it: a report does not load the user's file again."""

    title: str
    unit: str
    digits: int
    value: Any
    penalties: Mapping[str, float]
    events: tuple[Mapping[str, Any], ...]

    @property
    def heading(self) -> str:
        """What people call it."""
        return self.title

    @property
    def is_scored(self) -> bool:
        """Whether it enters the infraction score."""
        return bool(self.penalties)

    def text(self, result: JudgedRun) -> str:  # noqa: ARG002 - the value is here
        """Return the value: a number with its unit, a dash where there is none, or whatever it is."""
        if self.value is None or is_number(self.value):
            return shown(self.value, self.unit, self.digits)
        return str(self.value)


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """The judgement of one drive.

    Attributes:
        scores: of the thesis; None where nothing was driven.
        infractions: what entered the score, in order of time; collisions with their responsibility.
        metrics: the value of each of BASU's metrics by name.
        own: users' metrics by name.
        scoring: the rules as plain values, as ``result.json`` has them.
        meta: what was run.
        scenarios: those on the way of the route.
        case: the drive's own case with its verdict, as plain values; None for a drive on a route.
        success: passed or not, by the one rule; a document that an earlier version wrote is not judged.
        history: the record; None where nothing was driven, and in a result read from its document.
    """

    outcome: Outcome
    scores: Scores | None
    infractions: tuple[Evidence, ...]
    metrics: Mapping[str, Any]
    own: Mapping[str, OwnMetric] = field(default_factory=dict)
    scoring: Mapping[str, Any]
    meta: Mapping[str, Any]
    scenarios: tuple[Mapping[str, Any], ...] = ()
    case: Mapping[str, Any] | None = None
    success: Success = NOT_JUDGED
    history: History | None = field(default=None, compare=False, repr=False)

    @property
    def is_comparable(self) -> bool:
        """Whether the score can be compared: no failure ended it, and gate and route were the benchmark's."""
        return not (self.is_broken_off or self.is_open or self.has_own_route)

    @property
    def is_broken_off(self) -> bool:
        """Whether a failure ended the run, so that its score stands for a part of the drive."""
        return self.outcome.status not in COMPARABLE

    @property
    def is_open(self) -> bool:
        """Whether the agent could do everything in the world: no gate stood between it and the simulator."""
        return bool(self.meta.get("access", {}).get("open"))

    @property
    def has_own_route(self) -> bool:
        """Whether the agent drove a route that it had planned or brought itself."""
        return bool(self.meta.get("own_route"))

    @property
    def track(self) -> str | None:
        """What the agent learned of others; None for a run that was not driven by an agent of BASU's commands."""
        track: str | None = self.meta.get("access", {}).get("track")
        return track

    @property
    def collisions(self) -> tuple[Evidence, ...]:
        """The infractions that are collisions."""
        return tuple(found for found in self.infractions if found.responsibility is not None)

    def shown(self) -> tuple[Display, ...]:
        """Return all that can be shown of the metrics: BASU's in the order of tables, then users' own."""
        return (*built_in(), *self.own.values())

    def remarks(self) -> list[str]:
        """Return words that have to stand beside the driving score."""
        return [remark for each in self.shown() if (remark := each.remark(self))]

    def events(self) -> list[Mapping[str, Any]]:
        """What metrics report with place and time beside the infractions, in order of time."""
        rows = [row for metric in built_in() for row in metric.events(self.metrics.get(metric.name))]
        rows += [row for own in self.own.values() if not own.penalties for row in own.events]
        return sorted(rows, key=lambda row: (row["t_s"], row["kind"]))

    def document(self) -> dict[str, Any]:
        """Return the result as the document ``result.json``."""
        document = {
            "schema_version": SCHEMA_VERSION,
            "status": self.outcome.status.value,
            "fault": self.outcome.status.fault.name.lower(),
            "message": self.outcome.message,
            "passed": self.success.passed,
            "reasons": list(self.success.reasons),
            "scores": None if self.scores is None else self.scores._asdict(),
            "infractions": [row_of(found) for found in self.infractions],
            **{metric.name: self.metrics.get(metric.name, metric.nothing) for metric in built_in()},
            "metrics": {name: _own_to_json(own) for name, own in self.own.items()},
            "scoring": dict(self.scoring),
            "meta": dict(self.meta),
        }
        if self.scenarios:
            document["scenarios"] = [dict(row) for row in self.scenarios]
        if self.case is not None:
            document["case"] = dict(self.case)
        return document

    @classmethod
    def from_document(cls, document: Mapping[str, Any]) -> Result:
        """The result that :meth:`document` wrote, without its record."""
        scores = document["scores"]
        return cls(
            outcome=Outcome(Status(document["status"]), document["message"]),
            scores=None if scores is None else Scores(**scores),
            infractions=tuple(_evidence_of(row) for row in document["infractions"]),
            metrics={metric.name: document.get(metric.name, metric.nothing) for metric in built_in()},
            own={
                name: OwnMetric(**{**own, "events": tuple(own["events"])})
                for name, own in document.get("metrics", {}).items()
            },
            scoring=document["scoring"],
            meta=document["meta"],
            scenarios=tuple(document.get("scenarios", ())),
            case=document.get("case"),
            success=Success(document.get("passed"), tuple(document.get("reasons", ()))),
        )


COMPARABLE = frozenset(
    {
        Status.COMPLETED,
        Status.ROUTE_TIMEOUT,
        Status.ROUTE_BLOCKED,
        Status.ROUTE_DEVIATION,
        Status.SCENARIO_ENDED,
        Status.SCENARIO_TIMEOUT,
    }
)


def judge(
    outcome: Outcome,
    history: History | None,
    scoring: Scoring | None = None,
    meta: Mapping[str, Any] | None = None,
    *,
    own: Sequence[Metric] = (),
    scenarios: Sequence[Mapping[str, Any]] = (),
    case: Mapping[str, Any] | None = None,
) -> Result:
    """Judge a drive from its record; ``history`` is None where nothing was driven, ``own`` are users' metrics.

    The verdict of a ``case`` decides whether its drive passed; on a route the record decides.
    """
    scoring = scoring or Scoring()
    rules = scoring_to_json(scoring)
    rules["penalties"] |= {kind: factor for metric in own for kind, factor in metric.penalties.items()}
    empty = Result(
        outcome=outcome,
        scores=None,
        infractions=(),
        metrics={metric.name: metric.nothing for metric in built_in()},
        scoring=rules,
        meta=meta or {},
        scenarios=tuple(scenarios),
        case=case,
        own={metric.name: _own(metric, metric.nothing, ()) for metric in own},
        success=success(outcome, None, (), scenarios, case),
    )
    if history is None or len(history.frames) == 0:
        return empty
    drive = Drive(
        history=history,
        scoring=scoring,
        outcome=outcome,
        hears_lane_invasions=case is None,
        scenarios=tuple(scenarios) if case is None else (case,),
    )
    found = {metric.name: metric.find(drive) for metric in (*built_in(), *own)}
    scored = [event for metric in (*built_in(), *own) if metric.penalties for event in found[metric.name]]
    extra = math.prod(
        rules["penalties"][event.kind.value] for metric in own if metric.penalties for event in found[metric.name]
    )
    infraction = infraction_score(counts(tuple(scored)), scoring) * extra
    path = path_following(history).score
    blame = dict(responsibilities(history))
    return replace(
        empty,
        scores=Scores(driving_score(infraction, path, scoring), infraction, path),
        infractions=tuple(replace(each, responsibility=blame.get(each)) for each in in_order(scored)),
        metrics={metric.name: metric.compute(drive) for metric in built_in()},
        own={metric.name: _own(metric, metric.compute(drive), found[metric.name]) for metric in own},
        success=success(outcome, history, scored, scenarios, case),
        history=history,
    )


def _evidence_of(row: Mapping[str, Any]) -> Evidence:
    """The evidence that :func:`row_of` wrote."""
    kinds = {kind.value: kind for kind in (*Infraction, *Incident)}
    blame = row.get("responsibility")
    if blame is not None:
        blame = Responsibility(
            at_fault=blame["at_fault"], kind=CollisionKind(blame["kind"]), sentence=blame["sentence"]
        )
    return Evidence(**{**row, "kind": kinds.get(row["kind"], OwnKind(row["kind"])), "responsibility": blame})


def _own(metric: Metric, value: Any, events: Sequence[Evidence]) -> OwnMetric:  # noqa: ANN401 - as its schema says
    """The value of a user's metric."""
    return OwnMetric(
        title=metric.title,
        unit=metric.unit,
        digits=metric.digits,
        value=value,
        penalties=dict(metric.penalties),
        events=tuple(row_of(event) for event in events),
    )


def _own_to_json(own: OwnMetric) -> dict[str, Any]:
    return {
        "title": own.title,
        "unit": own.unit,
        "digits": own.digits,
        "value": own.value,
        "penalties": dict(own.penalties),
        "events": [dict(row) for row in own.events],
    }


ABOUT = (
    "Lengths in m, speeds in m/s, times in s of simulated time, the CARLA frame (y south). What could not be measured "
    "is null, never 0."
)


def result_schema() -> dict[str, Any]:
    """Return the schema: the typed parts of a result, with a property for each of BASU's metrics."""
    own = record(
        about_="a user's metric",
        title=text(),
        unit=text(),
        digits=integer(low=0),
        value={"description": "as the metric computes it"},
        penalties=mapping(number(low=0, high=1), about="factors by kind; none for a metric that is only reported"),
        events=listing(EVIDENCE),
    )
    scores = schema_of(Annotated[ScoresPart | None, "of the thesis, section 5.3; null where nothing was driven"])
    on_the_way = "the scenarios of the route, in its file's order; absent where it has none, or the options skip them"
    properties = {
        "schema_version": {"const": SCHEMA_VERSION},
        "status": choice([status.value for status in Status]),
        "fault": schema_of(FaultName),
        "message": text(about="how the run ended, a sentence"),
        "passed": flag(null=True, about="by the one rule of success; null says nothing of it"),
        "reasons": listing(text(), "why it did not pass, in sentences"),
        "scores": scores,
        "infractions": listing(EVIDENCE, "what entered the score, in order of time"),
        **{metric.name: {**metric.schema, "title": metric.title} for metric in built_in()},
        "metrics": mapping(own, about="users' metrics by name"),
        "scoring": schema_of(Annotated[ScoringPart, "what the scores were computed with"]),
        "scenarios": listing({"$ref": "#/$defs/scenario"}, on_the_way),
        "case": {"$ref": "#/$defs/case"},
        "meta": schema_of(Annotated[MetaPart, "what was run"]),
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "result.json: the judgement of one drive",
        "description": ABOUT,
        "type": "object",
        "required": [name for name in properties if name not in LATER],
        "additionalProperties": False,
        "properties": properties,
        "$defs": {
            "scenario": schema_of(ScenarioPart),
            "evidence": schema_of(EvidencePart),
            "case": schema_of(CasePart),
        },
    }
