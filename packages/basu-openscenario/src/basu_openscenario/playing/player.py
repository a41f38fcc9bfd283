"""The kinematic player: steps of a scenario from its first to its last moment, and the poses of all entities."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from basu_openscenario.playing.building import build
from basu_openscenario.playing.controllers import check_controllers
from basu_openscenario.playing.elements import State
from basu_openscenario.playing.towing import align, pull_trailers
from basu_openscenario.playing.transition import SMALL
from basu_openscenario.playing.world import World, make_world
from basu_openscenario.roads.network import Network
from basu_openscenario.roads.network_file import read_network

if TYPE_CHECKING:
    from collections.abc import Iterator

    from basu_openscenario.playing.elements import Element
    from basu_openscenario.playing.mover import Mover
    from basu_openscenario.reading.scenario_file import ScenarioFile

STEP_S = 0.01


class Pose(NamedTuple):
    """An entity at a moment: m, rad and m/s in OpenDRIVE's axes (x east, y north, z up, heading to the left)."""

    name: str
    x_m: float
    y_m: float
    z_m: float
    h_rad: float
    p_rad: float
    r_rad: float
    speed_mps: float


class Frame(NamedTuple):
    """All entities at a moment."""

    time_s: float
    poses: tuple[Pose, ...]


class Change(NamedTuple):
    """A change of state of an element of the storyboard."""

    time_s: float
    kind: str
    path: str
    state: str
    transition: str


@dataclass(slots=True)
class Player:
    """A scenario that is being played."""

    scenario: ScenarioFile
    world: World
    board: Element
    init: list[object]
    changes: list[Change] = field(default_factory=list)
    _begun: bool = False

    def frame(self) -> Frame:
        """Return the entities as they are now."""
        return Frame(self.world.time_s, tuple(_pose(one) for one in self.world.movers.values() if one.is_there))

    @property
    def is_over(self) -> bool:
        """Whether the storyboard has come to its end."""
        return self._begun and self.board.state is not State.RUNNING

    def step(self, step_s: float) -> bool:
        """Advance by a step; return False once the storyboard is over, and then nothing has moved.

        The first step has no length: it does the init actions, and checks the triggers for the first time.
        """
        world = self.world
        world.step_s = step_s
        if not self._begun:
            self._begin()
        self.board.check_triggers()
        for action in self.init:
            action.step()  # type: ignore[attr-defined]
        self.board.step()
        if self.board.state is not State.RUNNING:
            return False
        world.time_s += step_s
        self._move(step_s)
        return True

    def _begin(self) -> None:
        """Do the init actions, and start the storyboard."""
        self._begun = True
        movers = self.world.movers
        for mover in movers.values():
            if mover.tow is None:
                align(mover)
        for action in self.init:
            action.start()  # type: ignore[attr-defined]
        self.board.start()
        for mover in movers.values():
            mover.remember()
            mover.teleported = True

    def _move(self, step_s: float) -> None:
        """Move all entities for a step: first the vehicles, and then the trailers behind them."""
        world = self.world
        world.traffic.drive(world, step_s)
        for mover in world.movers.values():
            self._drive(mover, step_s)
        for mover in world.movers.values():
            mover.pull()
        pull_trailers(world.movers.values())
        for mover in world.movers.values():
            if mover.name not in world.traffic.drivers:  # no condition names a vehicle of traffic
                mover.watch(world.time_s)
            mover.settle(step_s)

    def _drive(self, mover: Mover, step_s: float) -> None:
        """Move an entity along its lane, unless an action has moved it in this step, or an agent drives it."""
        if mover.given is not None:
            mover.follow(mover.given, step_s)
        if mover.tow is not None:
            return
        if abs(mover.speed_mps) > SMALL and not mover.moved_along and mover.place.road is not None:
            mover.place.move(mover.speed_mps * step_s)
            mover.moved_along = mover.speed_is_set = True
        if not mover.place.at_end_of_road:
            mover.end_since_s = None
        elif mover.end_since_s is None:
            mover.end_since_s = self.world.time_s
        elif math.hypot(*mover.velocity_mps) < SMALL:
            mover.set_speed(0.0)

    def play(self, step_s: float = STEP_S, longest_s: float = 300.0) -> Iterator[Frame]:
        """Yield the entities after each step, from 0 s on, until the storyboard is over.

        Args:
            step_s: the length of a step.
            longest_s: after this time a scenario without an end ends.
        """
        if self.step(0.0):
            yield self.frame()
        while self.world.time_s < longest_s - SMALL and self.step(step_s):
            yield self.frame()


def _pose(mover: Mover) -> Pose:
    """Return the pose of an entity."""
    place = mover.place
    return Pose(mover.name, place.x_m, place.y_m, place.z_m, place.h_rad, place.p_rad, place.r_rad, mover.speed_mps)


def make_player(
    scenario: ScenarioFile, *, with_controllers: bool = True, ego: str | None = None, seed: int = 0
) -> Player:
    """Return a player of a scenario.

    Args:
        scenario: as its file has it.
        with_controllers: whether controllers of other programs are refused; otherwise all entities play as written.
        ego: the entity that an agent drives; its controllers do not count.
        seed: of the choices of traffic.

    Raises:
        ScenarioError: its road network cannot be read, or it asks for what is not supported.
    """
    if with_controllers:
        check_controllers(scenario, ego)
    network = read_network(scenario.road_file) if scenario.road_file is not None else Network(scenario.path)
    world = make_world(scenario, network)
    world.traffic.seed(seed)
    board, init = build(scenario, world)
    player = Player(scenario, world, board, list(init))
    for element in board.all():
        element.listeners.append(
            lambda one, state, transition: player.changes.append(
                Change(world.time_s, one.kind, one.path, state.value, transition)
            )
        )
    return player
