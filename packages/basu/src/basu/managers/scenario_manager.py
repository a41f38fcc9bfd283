"""`ScenarioManager`: spawns scenario actors near the ego, starts each at its trigger point, ticks and judges it.

A run may be a scenario's own (it begins and ends with it), or meet several on its route: then the cast of each comes
into the world when the ego is near, and the scenario begins when the ego reaches its trigger point.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

import carla
from py_trees.common import Status as NodeStatus

from basu.errors import ScenarioError, UserError
from basu.managers.base_manager import BaseManager
from basu.managers.placed_scenario import call_scenario, is_behind, place_scenario
from basu.managers.stage.environment import SharedWorld
from basu.managers.stage.live_stage import LiveStage
from basu.managers.stage.scenario_actors import destroy_actors, spawn_actors
from basu.outcome import Outcome, Status
from basu.scenarios.criteria.criterion import Played, moved
from basu.scenarios.scenario import set_on
from basu.scenarios.stage import Controls
from basu.scenarios.verdict import judge

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.managers.base_manager import Frame, Run
    from basu.managers.metrics_manager import MetricsManager
    from basu.managers.placed_scenario import PlacedScenario
    from basu.managers.routes_manager import RoutesManager
    from basu.records.history import History
    from basu.routing import Route
    from basu.scenarios.criteria.criterion import StandingThing
    from basu.scenarios.playable import Playable
    from basu.scenarios.scenario import Composed, Scenario
    from basu.scenarios.stage import ActorSpec
    from basu.scenarios.verdict import Judged

NEAR_M = 100.0  # before its trigger point along the route, a scenario's actors come into the world
LAST_CALL_M = 30.0  # until then, an actor without room on a busy road is spawned a moment later
AGAIN_TICKS = 10  # from one attempt to the next
AFTERMATH_S = 1.0  # a scenario's own run goes on for so long after the ego has touched an actor


@dataclass(slots=True)
class Playing:
    """One scenario in its run; what is not there yet is None."""

    planned: Playable
    scenario: Scenario
    composed: Composed
    stage: LiveStage
    cast: Sequence[ActorSpec] | None = None  # None: no actor is in the world yet
    armed_tick: int | None = None  # when it began
    touched_tick: int | None = None
    phase_ticks: dict[str, int] = field(default_factory=dict)  # when each phase began
    over: bool = False
    over_tick: int | None = None  # when it came to an end before its run did
    outcome: Outcome | None = None  # of that end
    error: ScenarioError | None = None  # why it could not be played to its end
    things: tuple[StandingThing, ...] = ()

    @property
    def triggered(self) -> bool:
        """Whether the conflict began."""
        return "conflict" in self.phase_ticks

    def played(self, history: History, outcome: Outcome) -> Played:
        """What its criteria may see, out of the record of the whole run."""
        step_s = history.facts.step_s
        return Played(
            history=history,
            outcome=outcome,
            roles=dict(self.stage.roles),
            things=self.things,
            phases_s={phase: tick * step_s for phase, tick in self.phase_ticks.items()},
            timeout_s=self.scenario.timeout_s,
        )

    def judged(self, history: History, outcome: Outcome) -> Judged:
        """The verdict, by the record of the whole run; criteria that raise are the scenario's own fault."""
        name = self.planned.case.name
        try:
            criteria = call_scenario(name, self.scenario.criteria)
            played = self.played(history, outcome)
            exercised = self.scenario.exercised
            return call_scenario(
                name, lambda: judge(criteria, played, outcome, triggered=self.triggered, exercised=exercised)
            )
        except UserError as error:
            return judge((), None, Outcome(Status.SETUP_FAILED, str(error)), triggered=self.triggered)

    def actors(self) -> list[dict[str, Any]]:
        """All actors that it spawned, as plain values for a result."""
        types = self.stage.types
        return [{"id": actor, "role": role, "type": types[actor]} for actor, role in self.stage.roles.items()]


class ScenarioManager(BaseManager):
    """Plays the scenarios of a run. After ``tick``, ``outcome`` says whether one of them has ended it."""

    def __init__(self, planned: Sequence[Playable], *, own: bool) -> None:
        """``own``: the run is the (one) scenario's, begins armed and ends with it."""
        self._planned, self._own = tuple(planned), own
        self._placed: list[PlacedScenario] = []
        self.playing: list[Playing] = []
        self.outcome: Outcome | None = None

    def join(self, routes: RoutesManager, metrics: MetricsManager) -> None:
        """Set the managers that it shares the run with; before ``setup``."""
        self._routes, self._metrics = routes, metrics

    def setup(self, run: Run) -> None:
        """Lay every scenario on the route; the cast of a run's own scenario comes at once.

        Raises:
            ScenarioError: one cannot be placed.
        """
        self._step_s = run.step_s
        self._shared = SharedWorld(run.world, run.changes)
        self.lay(run.route, run.carla_map)
        for placed in self._placed:
            stage = LiveStage(run, self._routes, self._metrics, placed.planned.case.name, self._shared, placed.way)
            self.playing.append(Playing(placed.planned, placed.scenario, placed.composed, stage))
        if self._own:
            for playing in self.playing:
                self._bring(playing)
                self._begin(playing, 0)

    def lay(self, route: Route, carla_map: carla.Map) -> None:
        """Lay every scenario on the route, once; nothing in the world is needed for that.

        Raises:
            ScenarioError: one has no place there.
        """
        if len(self._placed) < len(self._planned):
            self._placed = [place_scenario(planned, route, carla_map, own=self._own) for planned in self._planned]

    def reserved_m(self) -> list[tuple[float, float]]:
        """Return the places (x, y) that the casts of the laid scenarios will take.

        Raises:
            ScenarioError: a scenario's own code raised.
        """
        return [
            (spec.pose.x_m, spec.pose.y_m)
            for placed in self._placed
            for spec in call_scenario(placed.planned.case.name, partial(placed.planned.cast, placed.scenario))
        ]

    def try_out(self, client: carla.Client, world: carla.World) -> None:
        """Bring every cast, and take it away at once: what has no place in this world is known before the run begins.

        Raises:
            ScenarioError: an actor cannot be spawned.
        """
        for placed in self._placed:
            name = placed.planned.case.name
            cast = spawn_actors(client, world, call_scenario(name, partial(placed.planned.cast, placed.scenario)), name)
            destroy_actors(client, [member.actor for member in cast])

    def tick(self, frame: Frame) -> None:
        """Play a frame of every scenario that has begun."""
        self._shared.keep_up()
        for playing in self.playing:
            if playing.over:
                continue
            try:
                if playing.armed_tick is not None or self._begins(playing, frame.tick):
                    self._play(playing, frame)
            except ScenarioError as error:
                playing.error = error
                self._end(playing, frame.tick)
                if self._own:
                    raise

    def _begins(self, playing: Playing, tick: int) -> bool:
        """Bring the cast of a scenario that the ego comes near; whether it is at the trigger point."""
        place = playing.scenario.place
        ahead_m = place.trigger_s_m - self._routes.progress.s_m
        if ahead_m > NEAR_M:
            return False
        if playing.cast is None and (ahead_m <= LAST_CALL_M or tick % AGAIN_TICKS == 0):
            try:
                self._bring(playing)
            except ScenarioError:
                if ahead_m <= LAST_CALL_M:
                    raise
        if ahead_m > 0.0:
            return False
        self._begin(playing, tick)
        return True

    def through(self, control: carla.VehicleControl) -> carla.VehicleControl:
        """The ego's control after every disturbance."""
        asked_for = now = Controls(control.throttle, control.steer, control.brake)
        for playing in self.playing:
            if not playing.over:
                now = playing.stage.through(now)
        if now is asked_for:
            return control
        return carla.VehicleControl(
            throttle=min(1.0, max(0.0, now.throttle)),
            steer=min(1.0, max(-1.0, now.steer)),
            brake=min(1.0, max(0.0, now.brake)),
            hand_brake=control.hand_brake,
            reverse=control.reverse,
            manual_gear_shift=control.manual_gear_shift,
            gear=control.gear,
        )

    def close(self) -> None:
        """Clear every stage."""
        for playing in self.playing:
            if not playing.over:
                self._end(playing, None)

    def _bring(self, playing: Playing) -> None:
        """Bring the cast; on a route, actors that the ego would reach from behind come when it has passed."""
        cast = call_scenario(playing.planned.case.name, partial(playing.planned.cast, playing.scenario))
        playing.stage.enter(
            cast if self._own else [spec for spec in cast if not is_behind(playing.scenario.place, spec)]
        )
        playing.cast = cast

    def _begin(self, playing: Playing, tick: int) -> None:
        """Set the tree on its stage, and let the rest of the cast come."""
        cast, stage, name = playing.cast or (), playing.stage, playing.planned.case.name
        playing.armed_tick = tick
        stage.begin(tick)
        if not self._own:
            stage.enter([spec for spec in cast if is_behind(playing.scenario.place, spec)])
        stage.set_off(cast)
        call_scenario(name, partial(set_on, playing.composed, stage))

    def _play(self, playing: Playing, frame: Frame) -> None:
        """Play one frame of one scenario."""
        stage, root = playing.stage, playing.composed.root.root  # without visitors, which no tree has
        stage.look(frame)
        if not playing.things and frame.tick > (playing.armed_tick or 0):  # a new actor is in no frame yet
            playing.things = stage.things()
        call_scenario(playing.planned.case.name, root.tick_once)
        for phase, node in playing.composed.phases.items():
            if phase not in playing.phase_ticks and node.status is not NodeStatus.INVALID:
                playing.phase_ticks[phase] = frame.tick
        call_scenario(playing.planned.case.name, stage.carry_out)
        if stage.ego_contacts and playing.touched_tick is None:
            playing.touched_tick = frame.tick
        end = self._judged(playing, frame.tick)
        if end is not None:
            playing.outcome = end
            self._end(playing, frame.tick)
            if self._own:
                self.outcome = end

    def _judged(self, playing: Playing, tick: int) -> Outcome | None:
        """How a scenario ended, if it has."""
        status = playing.composed.root.root.status
        if status is NodeStatus.SUCCESS:
            return Outcome(
                Status.SCENARIO_ENDED, f"the scenario came to its end after {self._since_s(playing, tick):.1f} s"
            )
        if status is NodeStatus.FAILURE:
            failed = playing.composed.root.tip()
            words = "" if failed is None else f": {failed.name} {failed.feedback_message}".rstrip()
            raise ScenarioError(f"{playing.planned.case.name} could not be played{words}")
        if playing.touched_tick is not None and (tick - playing.touched_tick) * self._step_s >= AFTERMATH_S:
            touched = ", ".join(sorted(playing.stage.ego_contacts))
            return Outcome(Status.SCENARIO_ENDED, f"ended {AFTERMATH_S:g} s after the ego touched {touched}")
        if not (self._own or playing.triggered) and stage_left_m(playing.stage) <= 0.0:
            return Outcome(Status.SCENARIO_ENDED, "the ego went by")
        if self._since_s(playing, tick) >= playing.scenario.timeout_s:
            return Outcome(Status.SCENARIO_TIMEOUT, f"not over after {playing.scenario.timeout_s:g} s")
        return None

    def _since_s(self, playing: Playing, tick: int) -> float:
        """Return the time since the scenario was armed, in s."""
        return (tick - (playing.armed_tick or 0)) * self._step_s

    def _end(self, playing: Playing, tick: int | None) -> None:
        """Leave the world clean."""
        playing.over, playing.over_tick = True, tick
        playing.things = moved(playing.things, playing.stage.moves)
        playing.stage.clear()


def stage_left_m(stage: LiveStage) -> float:
    """How far the ego has to go to the end of a scenario's stretch of the route."""
    return stage.route.length_m - stage.ego_s_m
