"""The parts of ``result.json`` that are no metric, as typed dicts: scores, scoring, meta, scenarios, case, evidence.

The JSON Schema follows from them (`basu.metrics.json_schema.schema_of`).
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from typing_extensions import NotRequired, TypedDict

from basu.conditions import LeaderboardTrack, Track
from basu.metrics.infraction import CollisionKind
from basu.metrics.json_schema import Value, closed

Share = Annotated[float, Value(low=0, high=1)]
Amount = Annotated[float, Value(low=0)]
Count = Annotated[int, Value(low=0)]
FaultName = Literal["none", "agent", "setup", "simulator", "benchmark", "user"]
VerdictName = Literal[
    "SUCCESS",
    "FAILURE",
    "AGENT_FAULT",
    "NOT_EXERCISED",
    "SIMULATOR_FAULT",
    "SETUP_FAULT",
    "BENCHMARK_FAULT",
    "INTERRUPTED",
]


@closed
class ScoresPart(TypedDict):
    """The scores of the thesis."""

    driving: Share
    infraction: Share
    path_following: Share


@closed
class ScoringPart(TypedDict):
    """The rules that the scores were computed by."""

    penalties: Annotated[dict[str, Share], "factors on the infraction score, by kind"]
    infraction_weight: Share
    path_following_weight: Share
    speeding_tolerance_mps: Amount
    route_deviation_m: Amount
    comfort_weights: NotRequired[dict[str, Amount]]
    standing_place: NotRequired[dict[str, float]]
    harsh_stop_mps2: NotRequired[Amount]


@closed
class ResponsibilityPart(TypedDict):
    """The responsibility for a collision."""

    at_fault: bool
    kind: CollisionKind
    sentence: str


@closed
class EvidencePart(TypedDict):
    """One infraction or incident with its evidence."""

    kind: str
    tick: Count
    t_s: Amount
    x_m: float
    y_m: float
    z_m: float
    speed_mps: Amount
    route_s_m: float
    other: str | None
    detail: str
    responsibility: NotRequired[
        Annotated[ResponsibilityPart, "of a collision, by the rules of the road: docs/reference/fault.md"]
    ]


@closed
class AgentPart(TypedDict):
    """The agent of a drive."""

    name: str
    confinement: NotRequired[
        Annotated[
            list[Literal["processes", "sight", "results", "memory", "signals", "files", "ports"]] | None,
            "the parts of the confinement of its process that the kernel enforced; null with --in-process",
        ]
    ]
    file: str


AgentPart.__annotations__["class"] = str  # a word of Python's, so it cannot stand in the class


@closed
class TrafficPart(TypedDict):
    """The other road users that a drive had."""

    vehicles: Count
    walkers: Count
    density_per_km: Amount | None


@closed
class LeaderboardTrackPart(TypedDict):
    """The track of the CARLA leaderboard that the agent's sensors were held to."""

    track: LeaderboardTrack
    sensors: Annotated[list[str], "types of the admitted sensors, in the order of the set"]
    refused: Annotated[str | None, "the rule that the set broke"]


@closed
class AccessPart(TypedDict):
    """The agent's access to the simulator."""

    track: Annotated[Track, "what it learned of others: scores of different tracks are not compared"]
    open: Annotated[bool, "no gate stood between it and the simulator: the score is not comparable"]
    refused: Annotated[dict[str, Annotated[int, Value(low=1)]], "how often the gate refused each function"]
    leaderboard: NotRequired[LeaderboardTrackPart]


@closed
class MetaPart(TypedDict):
    """The drive, as it was made."""

    simulated_s: Amount
    wall_s: Amount
    ticks: Count
    step_s: Amount
    first_server_frame: int | None
    started: str
    seed: int
    agent: AgentPart
    vehicle: str
    weather: str
    traffic: TrafficPart
    route: str
    own_route: NotRequired[
        Annotated[bool, "the agent planned the route or brought its file: the score is not comparable"]
    ]
    town: str
    versions: dict[str, str]
    access: NotRequired[
        Annotated[AccessPart, "the agent's access to the simulator; absent in results without an agent"]
    ]


@closed
class ParameterPart(TypedDict):
    """A parameter of a scenario."""

    name: str
    value: float | str
    unit: str
    about: str


class FindingPart(TypedDict):
    """An answer of the policy."""

    holds: Annotated[bool | None, "null where it could not be judged"]
    sentence: str


class AssessmentPart(TypedDict):
    """The answers of the policy."""

    safe: FindingPart
    completed: FindingPart
    exercised: FindingPart


class CollisionPart(TypedDict):
    """A contact of the ego."""

    t_s: Amount
    other: Annotated[str, "a role, a thing's name or a blueprint's id"]
    speed_mps: Annotated[float, "of the ego in the frame before"]
    at_fault: Annotated[bool, "by the rules of the road: docs/reference/fault.md"]
    kind: Annotated[str, "of nuPlan's collision types"]
    sentence: str


class JudgementPart(TypedDict):
    """The judgement of a criterion."""

    criterion: str
    passed: Annotated[bool | None, "null where there was nothing to judge by"]
    deciding: Annotated[bool, "whether the verdict depends on it"]
    measured: Annotated[float | None, "in unit"]
    unit: str
    limit: Annotated[str, "what it was held against"]
    sentence: Annotated[str, "time, place, other party, speed"]
    t_s: Annotated[float | None, "of the moment that decided"]
    x_m: float | None
    y_m: float | None
    speed_mps: NotRequired[Annotated[float | None, "of the ego then"]]
    other: Annotated[str | None, "a role, a thing's name or a blueprint's id"]


class MarginsPart(TypedDict):
    """How narrowly a case went."""

    distance_m: float | None
    ttc_s: float | None
    pet_s: float | None


@closed
class ActorPart(TypedDict):
    """An actor that a scenario brought."""

    id: Count
    role: str
    type: str


class ThingPart(TypedDict):
    """Something that stood in a scenario and is no actor of the record."""

    name: str
    x_m: float
    y_m: float
    yaw_rad: float
    half_length_m: Amount
    half_width_m: Amount
    from_s: NotRequired[Annotated[float, "when it came to stand there"]]
    until_s: NotRequired[Annotated[float | None, "when it was put elsewhere or taken away"]]
    rolled_over: NotRequired[Annotated[bool, "whether it is so low that wheels roll over it"]]


PreCrash = Annotated[
    list[Annotated[int, Value(low=1, high=37)]],
    "numbers of the pre-crash scenarios of DOT HS 810 767 that it stands for",
]


@closed
class ScenarioPart(TypedDict):
    """A scenario on the way, judged by the part of the run from its trigger point to its end."""

    id: Annotated[str, "its name in the route file"]
    scenario: Annotated[str, "the class"]
    title: str
    group: Annotated[str, "of NHTSA's pre-crash typology"]
    parameters: list[ParameterPart]
    unread: Annotated[list[str], "values of the file that ScenarioRunner's class reads and ours does not"]
    trigger_s_m: Annotated[float, Value("along the route", low=0)]
    pre_crash: NotRequired[PreCrash]
    characteristics: NotRequired[Annotated[dict[str, str], "after table 3.1 of the thesis"]]
    assessment: NotRequired[
        Annotated[
            dict[str, Any] | None,
            "safe, completed, exercised: each holds or not, with a sentence; null where it was not judged",
        ]
    ]
    collisions: NotRequired[Annotated[list[dict[str, Any]], "contacts, and whether the vehicle is at fault for them"]]
    reached: Annotated[bool, "whether the ego came to its trigger point"]
    verdict: Annotated[VerdictName | None, "null where it was not reached"]
    fault: FaultName
    message: Annotated[str, "why, a sentence"]
    began_s: Amount | None
    ended_s: Annotated[Amount | None, "null where the run ended before"]
    phases_s: Annotated[dict[str, float], "when each began"]
    judgements: list[JudgementPart]
    margins: dict[str, float | None]
    tree: Annotated[dict[str, Any], "name, kind, status, feedback, children"]
    actors: list[ActorPart]
    things: list[dict[str, Any]]
    timeout_s: Amount
    timed_out: NotRequired[Annotated[bool, "whether its time was used up; absent in results of earlier versions"]]
    scenarios_file: Annotated[str, "file and line"]


class MeasuredPart(TypedDict):
    """Figures of route and drive where a conflict began."""

    posted_mps: Annotated[float | None, "null where the map posts none"]
    travel_mps: Annotated[float, Value("of the ego", low=0)]
    in_bend: Annotated[bool, "a radius of 100 m or less within 50 m"]
    level: Annotated[bool, "a grade below 3 % within 50 m"]


class CasePart(TypedDict):
    """One scenario at one place with one agent, judged."""

    id: Annotated[str, "of the case, by which it can be played alone"]
    scenario: Annotated[str, "the class"]
    title: Annotated[str, "what happens, a line"]
    group: Annotated[str, "of NHTSA's pre-crash typology, or shuttle"]
    place: Annotated[str, "where, in words"]
    on_route: Annotated[bool, "whether on the shuttle's way"]
    characteristics: Annotated[dict[str, str], "after table 3.1 of the thesis, as --where takes them"]
    pre_crash: PreCrash
    measured: Annotated[MeasuredPart | None, "where the conflict began; null where it never did"]
    parameters: list[ParameterPart]
    agent: str
    vehicle: Annotated[str, "of the ego, a blueprint's id"]
    seed: int
    town: str
    verdict: Annotated[
        VerdictName,
        "only the first three say something about the agent; NOT_EXERCISED: the conflict never came about",
    ]
    fault: Annotated[FaultName, "the party at fault; none where the driving was judged"]
    status: Annotated[str, "how the drive ended"]
    message: Annotated[str, "why the verdict is what it is, a sentence"]
    assessment: Annotated[AssessmentPart | None, "the answers of the policy; null where nothing was recorded"]
    collisions: list[CollisionPart]
    ended: NotRequired[Annotated[str, "how the drive ended, a sentence"]]
    phases_s: Annotated[dict[str, Amount], "when each phase began; those not reached are absent"]
    judgements: list[JudgementPart]
    margins: Annotated[MarginsPart, "how narrowly, least of all; null where no actor came near"]
    tree: Annotated[
        dict[str, Any] | None,
        "the behaviour tree with its criteria as it ended: a node; null where nothing was played",
    ]
    actors: list[ActorPart]
    things: Annotated[list[ThingPart], "what stood in the scenario and is no actor of the record"]
    scenarios_file: Annotated[str, "where the case is written, file and line"]
    command: Annotated[list[str], "plays it alone again"]
    simulated_s: Amount
    wall_s: Amount
