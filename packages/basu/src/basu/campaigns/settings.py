"""The settings of a campaign: ``campaign.toml``, checked whole before anything is started."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from basu.conditions import Track
from basu.errors import UserError
from basu.settings.option import suggestion

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    from pathlib import Path

AS_GIVEN = "as given"  # the weather of the route or the case; ClearNoon without one
NAME = r"^[A-Za-z0-9][A-Za-z0-9._-]*$"  # a folder is called so


class Table(BaseModel):
    """A table of the file; unknown keys are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class OtherTraffic(Table):
    """Road users beside the vehicle under test, on routes."""

    vehicles: Annotated[int, Field(ge=0)] = 0
    walkers: Annotated[int, Field(ge=0)] = 0
    density_per_km: Annotated[float | None, Field(ge=0.0)] = None  # vehicles on a km of lane, in place of ``vehicles``


class Seeds(Table):
    """Consecutive seeds."""

    first: Annotated[int, Field(ge=0)] = 0
    number: Annotated[int, Field(ge=1)] = 1


class Search(Table):
    """Adaptive drives towards the boundary between success and failure, for each case and agent."""

    drives: Annotated[int, Field(ge=8, le=1_000)]
    first: Annotated[int | None, Field(ge=4)] = None  # space-filling ones; None: a third of all
    batch: Annotated[int, Field(ge=1, le=100)] = 8  # proposals from one state of knowledge
    seed: Annotated[int, Field(ge=0)] = 0

    @model_validator(mode="after")
    def _has_room(self) -> Search:
        if self.first is not None and self.first > self.drives:
            raise ValueError("first is more than drives; leave some drives for the search")
        return self

    @property
    def space_filling(self) -> int:
        """The number of drives in the first round."""
        return max(4, self.drives // 3) if self.first is None else self.first


class Normal(Table):
    """A normal distribution, cut off at the ends of its parameter's range."""

    mean: float
    deviation: Annotated[float, Field(gt=0.0)]


class EstimateSettings(Table):
    """Weighted drives that estimate the probability of a rare failure, for each case and agent."""

    drives: Annotated[int, Field(ge=10, le=1_000_000)]  # in the estimate
    learn: Annotated[int, Field(ge=0, le=10_000)] = 0  # drives before, which move the proposal to the failures
    batch: Annotated[int, Field(ge=10, le=10_000)] = 50  # drives from one state of knowledge
    elite: Annotated[float, Field(gt=0.0, le=0.5)] = 0.1  # share of the most severe drives that moves the proposal
    plain: Annotated[float, Field(ge=0.01, le=1.0)] = 0.1  # share of drives from the distribution itself
    normal: dict[str, Normal] = {}  # by parameter; all others are uniform over their range
    seed: Annotated[int, Field(ge=0)] = 0


Weathers = Annotated[tuple[str, ...], Field(min_length=1)]
Traffics = Annotated[tuple[OtherTraffic, ...], Field(min_length=1)]


DESIGNS = ("sweep", "grid", "search", "estimate")


class Drives(Table):
    """A set of drives: routes of a file, or cases of scenarios with their parameters."""

    routes: str | None = None  # a route file
    route_ids: tuple[str, ...] = ()  # only these of it
    scenarios: bool = True  # whether the scenarios on a route's way are played
    cases: tuple[str, ...] = ()  # words of `basu scenario run`: all, a group, a scenario, a case's id, FILE.xml
    fixed: Annotated[dict[str, str | float], Field(alias="set")] = {}
    sweep: Annotated[int | None, Field(ge=1)] = None  # samples of each case, a Latin hypercube
    sweep_seed: Annotated[int, Field(ge=0)] = 0
    grid: Annotated[int | None, Field(ge=2)] = None  # values of every number
    search: Search | None = None  # towards the boundary of failure
    estimate: EstimateSettings | None = None  # of the probability of failure
    vary: tuple[str, ...] = ()  # the parameters to sample; empty: all
    weather: Weathers | None = None  # None: that of the campaign
    traffic: Traffics | None = None
    seeds: Seeds | None = None

    @model_validator(mode="after")
    def _one_kind(self) -> Drives:
        if (self.routes is None) == (not self.cases):
            raise ValueError("name either routes = FILE or cases = [...]")
        if self.cases and (self.route_ids or self.traffic is not None):
            raise ValueError("route_ids and traffic are for routes; a case has its own place and road users")
        designs = [name for name in DESIGNS if getattr(self, name) is not None]
        if self.routes and (self.fixed or designs or self.vary):
            raise ValueError("set, sweep, grid, search, estimate and vary are for cases; a route has no parameters")
        if len(designs) > 1:
            raise ValueError(f"{' and '.join(designs)} are two designs; choose one")
        return self

    @property
    def is_adaptive(self) -> bool:
        """Whether drives depend on what came of others."""
        return self.search is not None or self.estimate is not None


class Until(Table):
    """When the question is answered: every agent's interval is narrow enough."""

    width: Annotated[float, Field(gt=0.0, lt=1.0)]  # of the interval of the success rate
    least: Annotated[int, Field(ge=1)] = 100  # distinct judged drives of each agent before the first look
    every: Annotated[int, Field(ge=1)] = 100  # drives from one look to the next


class Keep(Table):
    """Which drives leave a folder with their record, for each agent."""

    failures: Annotated[int, Field(ge=0)] = 100  # as many at most
    narrowest: Annotated[int, Field(ge=0)] = 20  # of the successes
    sample: Annotated[float, Field(ge=0.0, le=1.0)] = 0.01  # share of all drives, chosen by their ids


class Work(Table):
    """How drives are worked off; nothing of it changes a result."""

    block: Annotated[int, Field(ge=1, le=1_000_000)] = 1_000  # drives in one file of the table, of all agents
    attempts: Annotated[int, Field(ge=1, le=10)] = 3  # at a drive, where its worker dies
    drive_limit_s: Annotated[float, Field(gt=0.0)] = 3_600.0  # wall time of one drive; longer counts as a death


class Campaign(Table):
    """The whole file."""

    name: Annotated[str, Field(pattern=NAME, max_length=80)]
    agents: Annotated[tuple[str, ...], Field(min_length=1)]
    drives: Annotated[tuple[Drives, ...], Field(min_length=1)]
    weather: Weathers = (AS_GIVEN,)
    traffic: Traffics = (OtherTraffic(),)
    seeds: Seeds = Seeds()
    order: Literal["given", "shuffled"] = "given"
    shuffle_seed: Annotated[int, Field(ge=0)] = 0
    vehicle: str | None = None
    tracks: dict[str, Track] = {}  # by agent as it stands in ``agents``; without an entry: as its config() asks
    open: bool = False  # without the gate, for development; the scores are marked as not comparable
    step_limit_s: Annotated[float, Field(gt=0.0)] = 10.0
    agent_memory_gb: Annotated[float | None, Field(gt=0.0)] = None
    agent_writes: tuple[str, ...] = ()
    scenario_files: tuple[str, ...] = ()
    metric_files: tuple[str, ...] = ()
    scoring: dict[str, Any] = {}
    confidence: Annotated[float, Field(gt=0.5, lt=1.0)] = 0.95
    until: Until | None = None
    keep: Keep = Keep()
    work: Work = Work()

    @model_validator(mode="after")
    def _tracks_of_agents(self) -> Campaign:
        for name in self.tracks:
            if name not in self.agents:
                raise ValueError(f"tracks names '{name}', which is none of the agents; it can name {self.agents}")
        return self

    @model_validator(mode="after")
    def _adaptive_alone(self) -> Campaign:
        adaptive = [drives.is_adaptive for drives in self.drives]
        if any(adaptive) and not all(adaptive):
            raise ValueError(
                "drives of a search lie where failures are, so their rates mean nothing beside others; put them into a "
                "campaign of their own"
            )
        if any(adaptive) and (self.order != "given" or self.until is not None):
            raise ValueError("a search chooses its order and its end; leave out order and [until]")
        return self

    @property
    def block(self) -> int:
        """Drives in a block: from one look to the next, where there are looks."""
        return self.work.block if self.until is None else self.until.every


def read_campaign(path: Path) -> Campaign:
    """The campaign in a file.

    Raises:
        UserError: it cannot be read, is no TOML, or has a key or value that means nothing; names the first mistake.
    """
    try:
        document = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise UserError(f"the campaign {path} cannot be read: {error.strerror}; name a campaign.toml") from error
    except ValueError as error:
        raise UserError(f"the campaign {path} is no TOML: {error}") from error
    return checked(document, str(path))


def checked(document: dict[str, Any], source: str) -> Campaign:
    """The campaign of a document that was read from ``source``.

    Raises:
        UserError: see ``read_campaign``.
    """
    try:
        return Campaign.model_validate(document)
    except ValidationError as error:
        raise UserError(f"{source}: {_sentence(error.errors()[0])}") from None


def _sentence(mistake: Any) -> str:  # noqa: ANN401 - a dictionary of pydantic's
    """Return the first mistake: its place and what it must be."""
    # a value of `set` may be a text or a number; the library appends the kind that it tried
    where = mistake["loc"][:-1] if "set" in mistake["loc"][:-2] else mistake["loc"]
    place = ".".join(str(part) for part in where)
    kind = mistake["type"]
    if kind == "extra_forbidden":
        table = next((model for name, model in _TABLES.items() if name in mistake["loc"][:-1]), Campaign)
        known = [field.alias or name for name, field in table.model_fields.items()]
        return f"{place} means nothing here; {suggestion(str(mistake['loc'][-1]), known)}"
    if kind == "value_error":
        return f"{place}: {mistake['ctx']['error']}".removeprefix(": ")
    if kind == "missing" and len(where) > 1:
        return f"{place} is missing; give it a value"
    if kind in _NOTHING:
        return f"{place} {_NOTHING[kind]}"
    if where != mistake["loc"]:
        return f"{place} is {mistake['input']!r}; write a text in quotation marks or a number"
    return f"{place} is {mistake['input']!r}; {_wanted(mistake)}"


def _wanted(mistake: Any) -> str:  # noqa: ANN401 - a dictionary of pydantic's
    """Return what must stand in the place of a value, in words of the file and not of the library."""
    if mistake["type"] == "model_type":
        return f"write a table with {', '.join(_keys_of(mistake['loc']))}"
    return _WANTED[mistake["type"]].format(**mistake.get("ctx", {}))


def _keys_of(place: tuple[Any, ...]) -> list[str]:
    """Return the keys of the table at a place of the file."""
    if "normal" in place:
        return list(Normal.model_fields)
    model = next(_TABLES[name] for name in reversed(place) if name in _TABLES)
    return [field.alias or name for name, field in model.model_fields.items()]


_NOTHING = {
    "missing": "is missing; every campaign has name, agents and [[drives]]",
    "too_short": "is empty, so there is nothing to drive; name at least one",
}
_WANTED = {
    "string_pattern_mismatch": "use letters, digits, '.', '_' and '-', and begin with a letter or digit",
    "string_too_long": "use {max_length} characters at most",
    "literal_error": "write {expected}",
    "enum": "write {expected}",
    "greater_than": "write a number above {gt}",
    "greater_than_equal": "write {ge} or more",
    "less_than": "write a number below {lt}",
    "less_than_equal": "write {le} or less",
    "finite_number": "write a finite number",
    "tuple_type": "write a list in square brackets",
    "dict_type": "write a table: {{KEY = VALUE}}",
    "string_type": "write a text in quotation marks",
    "int_type": "write a whole number",
    "int_from_float": "write a whole number",
    "int_parsing": "write a whole number",
    "float_type": "write a number",
    "float_parsing": "write a number",
    "bool_type": "write true or false",
    "bool_parsing": "write true or false",
}


_TABLES: dict[str, type[Table]] = {
    "until": Until,
    "keep": Keep,
    "work": Work,
    "seeds": Seeds,
    "traffic": OtherTraffic,
    "search": Search,
    "estimate": EstimateSettings,
    "drives": Drives,
}
