"""`OpenScenario`: the scenario class of a file, with the file's parameters, the ego's entity and its way."""

from __future__ import annotations

import functools
import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, NamedTuple

from basu.errors import ScenarioError
from basu.scenarios.actions import Wait
from basu.scenarios.criteria import NoCollision
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec, Pose
from basu.scenarios.xml_elements import Case, GivenActor
from basu_openscenario.playing.player import make_player
from basu_openscenario.reading.scenario_file import ScenarioFile, read_scenario
from basu_openscenario.staging.bodies import blueprint_of, middle_of
from basu_openscenario.staging.play_file import PlayFile
from basu_openscenario.staging.refusals import check_staged
from basu_openscenario.staging.way import way_along

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.parameters import Parameter, Value
    from basu.scenarios.place import Place
    from basu_openscenario.playing.player import Player
    from basu_openscenario.roads.place import Place as RoadPlace

EGO_NAMES = ("ego", "hero", "egovehicle", "ego_vehicle")
"""Names of entities that an agent drives unless --ego names another, without regard to case."""
AGENT, FILE = "agent", "file"
LONGEST_S = 60.0
"""A storyboard without an end is played for so long."""
STEP_S = 0.02
"""Of the play as written that shows the ego's way."""
SAMPLE_M = 5.0
"""Distance of the places of the ego from which its way is made."""


class Rehearsed(NamedTuple):
    """What a file means with some values: the ego's first place, its way, and how long the storyboard lasts."""

    scenario: ScenarioFile
    start: Pose
    way: tuple[Pose, ...]
    lasts_s: float


class OpenScenario(Scenario):
    """An OpenSCENARIO file: the entities move as written, and an agent drives the ego."""

    group = Group.SHUTTLE
    file: ClassVar[Path]
    defaults: ClassVar[Mapping[str, str]] = {}
    """The parameters of the file with their defaults."""
    needs_m = 100.0

    @classmethod
    def settled(cls, case: Case, values: Mapping[str, Value]) -> Case:
        """Return the case with the ego's place and way, which follow from the values."""
        found = rehearsed(cls.file, _ego_of(values), _given(cls, case.values))
        entity = found.scenario.entities[_ego_of(values)]
        ego = GivenActor(role="hero", model=blueprint_of(entity), pose=found.start)
        return replace(case, ego=ego, way=found.way)

    def __init__(self, place: Place, values: Mapping[str, Value]) -> None:
        """Read the file with the values, and do the init actions."""
        super().__init__(place, values)
        self.ego, self.by_agent = _ego_of(values), values["driver"] == AGENT
        given = {name: _text(values[name]) for name in self.defaults if name in values}
        given = {name: text for name, text in given.items() if not _same(text, self.defaults[name])}
        self.found = rehearsed(self.file, self.ego, tuple(given.items()))
        self.timeout_s = 2.0 * self.found.lasts_s + LONGEST_S  # type: ignore[misc]
        self.player: Player = make_player(self.found.scenario, ego=self.ego)
        self.player.step(0.0)

    def actors(self) -> Sequence[ActorSpec]:
        """Return the entities besides the ego, where the init actions put them."""
        movers = [one for name, one in self.player.world.movers.items() if name != self.ego and one.is_there]
        return [
            ActorSpec(one.name, blueprint_of(one.entity), middle_of(one), speed_mps=one.speed_mps) for one in movers
        ]

    def trigger(self) -> Behaviour:
        """Begin at once: the storyboard has triggers of its own."""
        return Wait(0.0)

    def conflict(self) -> Behaviour:
        """Play the storyboard."""
        return PlayFile(self.player, self.ego, by_agent=self.by_agent, longest_s=self.found.lasts_s + LONGEST_S)

    def resolution(self) -> Behaviour:
        """End with the storyboard."""
        return Wait(0.0)

    def criteria(self) -> Sequence[Criterion]:
        """No contact: the file has no criteria that every program knows."""
        return [NoCollision()]


def _ego_of(values: Mapping[str, Value]) -> str:
    """Return the entity that is the ego."""
    return str(values["ego"])


def _text(value: Value) -> str:
    """Return a value as an attribute has it."""
    return value if isinstance(value, str) else repr(value).removesuffix(".0")


def _same(text: str, default: str) -> bool:
    """Return whether two texts mean the same value."""
    try:
        return float(text) == float(default)
    except ValueError:
        return text == default


def _given(cls: type[OpenScenario], values: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
    """Return the values of the file's parameters that differ from their defaults."""
    return tuple((name, text) for name, text in values.items() if name in cls.defaults and text != cls.defaults[name])


@functools.lru_cache(maxsize=256)
def rehearsed(file: Path, ego: str, given: tuple[tuple[str, str], ...]) -> Rehearsed:
    """Return what a file means with some values, after it was played in the kinematic mode as written.

    Raises:
        ScenarioError: it cannot be played, or there is no such entity.
    """
    scenario = read_scenario(file, dict(given))
    check_staged(scenario)
    player = make_player(scenario, ego=ego)
    mover = player.world.mover(ego)
    places: list[RoadPlace] = []
    lasts_s = 0.0
    start: Pose | None = None
    for frame in player.play(STEP_S, LONGEST_S):
        lasts_s = frame.time_s
        start = start or middle_of(mover)
        if not places or math.hypot(mover.place.x_m - places[-1].x_m, mover.place.y_m - places[-1].y_m) >= SAMPLE_M:
            places.append(mover.place.copy())
    if start is None:
        raise ScenarioError(f"{file}: the storyboard is over before it begins; correct its <StopTrigger>")
    return Rehearsed(scenario, start, way_along([*places, mover.place]), lasts_s)


def parameters_of(scenario: ScenarioFile, ego: str) -> tuple[Parameter, ...]:
    """Return the parameters of a file for BASU: the ego, its driver, and the file's own numbers and truth values."""
    vehicles = [one.name for one in scenario.entities.values() if one.kind == "vehicle"]
    found: list[Parameter] = [
        Choice("ego", (ego, *(name for name in vehicles if name != ego)), "the entity that the agent drives"),
        Choice("driver", (AGENT, FILE), "of the ego: the agent, or the file as it is written"),
    ]
    for name, one in scenario.declarations.items():
        if name in {"ego", "driver"}:
            continue
        if one.kind == "boolean":
            words = ("true", "false") if one.value.lower() in {"true", "1"} else ("false", "true")
            found.append(Choice(name, words, "a parameter of the file"))
        elif one.kind not in {"string", "dateTime"}:
            found.append(Number(name, float(one.value), one.low, one.high, "", "a parameter of the file"))
    return tuple(found)


def ego_of(scenario: ScenarioFile) -> str:
    """Return the entity that an agent drives unless another one is named: by its name, otherwise the first vehicle.

    Raises:
        ScenarioError: there is no vehicle.
    """
    vehicles = [one.name for one in scenario.entities.values() if one.kind == "vehicle"]
    if not vehicles:
        raise ScenarioError(f"{scenario.path}: the scenario has no vehicle that an agent can drive; add one")
    return next((name for name in vehicles if name.lower() in EGO_NAMES), vehicles[0])
