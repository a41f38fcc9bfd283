"""The scenarios of a run: armed when the ego comes near, ticked once a frame, judged afterwards, gone without trace.

A run may be a scenario's own (it ends with it), or meet several on its route.
"""

from __future__ import annotations

import traceback
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING

import carla
from py_trees.common import Status as NodeStatus

from basu.errors import BasuError, ScenarioError, SimulatorError
from basu.managers.base_manager import BaseManager
from basu.managers.stage.live_stage import LiveStage
from basu.outcome import Outcome, Status
from basu.routing.progress import Progress, advance
from basu.scenarios.criteria.criterion import Played
from basu.scenarios.place import Place
from basu.scenarios.stage import Controls
from basu.scenarios.tree import compose, set_on

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from typing import TypeVar

    from basu.history import History
    from basu.managers.base_manager import Frame, Run
    from basu.managers.metrics_manager import MetricsManager
    from basu.managers.routes_manager import RoutesManager
    from basu.routing import Route
    from basu.scenarios.config.model import Case
    from basu.scenarios.criteria.criterion import Thing
    from basu.scenarios.library import Playable
    from basu.scenarios.scenario import Scenario
    from basu.scenarios.tree import Composed

    T = TypeVar("T")

ARM_M = 100.0  # before its trigger point along the route, a scenario's actors come into the world
AFTERMATH_S = 1.0  # a scenario's own run goes on for so long after the ego has touched somebody


@dataclass(slots=True)
class Playing:
    """One scenario in its run; what is not there yet is None."""

    planned: Playable
    scenario: Scenario
    composed: Composed
    stage: LiveStage
    armed_tick: int | None = None
    touched_tick: int | None = None
    phase_ticks: dict[str, int] = field(default_factory=dict)  # when each phase began
    over: bool = False
    error: ScenarioError | None = None  # why it could not be played to its end
    things: tuple[Thing, ...] = ()

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


class ScenarioManager(BaseManager):
    """Plays the scenarios of a run. After ``tick``, ``outcome`` says whether one of them has ended it."""

    def __init__(self, planned: Sequence[Playable], *, own: bool) -> None:
        """``own``: the run is the (one) scenario's, begins armed and ends with it."""
        self._planned, self._own = tuple(planned), own
        self.playing: list[Playing] = []
        self.outcome: Outcome | None = None

    def join(self, routes: RoutesManager, metrics: MetricsManager) -> None:
        """Say whom it shares the run with; before ``setup``."""
        self._routes, self._metrics = routes, metrics

    def setup(self, run: Run) -> None:
        """Lay every scenario on the route; the cast of a run's own scenario comes at once.

        Raises:
            ScenarioError: one cannot be laid out.
        """
        self._step_s = run.step_s
        for planned in self._planned:
            place = place_of(planned.case, run.route, run.carla_map)
            who = planned.case.name
            scenario = asked(who, partial(planned.scenario, place, planned.values))
            composed = asked(who, partial(compose, scenario))
            stage = LiveStage(run, self._routes, self._metrics, who)
            self.playing.append(Playing(planned, scenario, composed, stage))
        if self._own:
            for playing in self.playing:
                self._arm(playing, 0)

    def tick(self, frame: Frame) -> None:
        """Play a frame of every scenario that is armed."""
        for playing in self.playing:
            if playing.over:
                continue
            try:
                if playing.armed_tick is None:
                    if self._routes.progress.s_m < playing.scenario.place.trigger_s_m - ARM_M:
                        continue
                    self._arm(playing, frame.tick)
                self._play(playing, frame)
            except ScenarioError as error:
                playing.error = error
                self._end(playing)
                if self._own:
                    raise

    def through(self, control: carla.VehicleControl) -> carla.VehicleControl:
        """What the ego is told after every disturbance; a control of its own where there is one."""
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
                self._end(playing)

    def _arm(self, playing: Playing, tick: int) -> None:
        """Bring the cast, and set the tree on its stage."""
        playing.armed_tick = tick
        playing.stage.begin(tick)
        who = playing.planned.case.name
        playing.stage.enter(asked(who, playing.scenario.actors))
        playing.things = playing.stage.things()
        asked(who, partial(set_on, playing.composed, playing.stage))

    def _play(self, playing: Playing, frame: Frame) -> None:
        """One frame of one scenario."""
        stage, root = playing.stage, playing.composed.root
        stage.look(frame)
        asked(playing.planned.case.name, root.tick)
        for phase, node in playing.composed.phases.items():
            if phase not in playing.phase_ticks and node.status is not NodeStatus.INVALID:
                playing.phase_ticks[phase] = frame.tick
        asked(playing.planned.case.name, stage.carry_out)
        if stage.ego_contacts and playing.touched_tick is None:
            playing.touched_tick = frame.tick
        end = self._judged(playing, frame.tick)
        if end is not None:
            self._end(playing)
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
        if self._since_s(playing, tick) >= playing.scenario.timeout_s:
            return Outcome(Status.SCENARIO_TIMEOUT, f"not over after {playing.scenario.timeout_s:g} s")
        return None

    def _since_s(self, playing: Playing, tick: int) -> float:
        """Since it was armed."""
        return (tick - (playing.armed_tick or 0)) * self._step_s

    def _end(self, playing: Playing) -> None:
        """Leave the world clean."""
        playing.over = True
        playing.stage.clear()


def place_of(case: Case, route: Route, carla_map: carla.Map) -> Place:
    """A case laid on the ego's route: its trigger point is the nearest place of it."""
    s_m = 0.0
    if case.trigger is not None:
        s_m = nearest_s_m(route, case.trigger.x_m, case.trigger.y_m)
    return Place(route=route, trigger_s_m=s_m, carla_map=carla_map, others=case.others)


def nearest_s_m(route: Route, x_m: float, y_m: float) -> float:
    """How far along a route its point nearest to a place is."""
    away2 = (route.points_m[:, 0] - x_m) ** 2 + (route.points_m[:, 1] - y_m) ** 2
    return float(advance(route, Progress(float(route.s_m[int(away2.argmin())]), 0.0, 0.0), x_m, y_m).s_m)


def asked(who: str, call: Callable[[], T]) -> T:
    """One call of a scenario's code; what goes wrong in it is the scenario's.

    Raises:
        ScenarioError: it raised.
        SimulatorError: the simulator did not answer it.
    """
    try:
        return call()
    except BasuError:
        raise
    except RuntimeError as error:
        if "time-out" in str(error):
            raise SimulatorError(f"the simulator failed in the scenario {who}: {error}") from error
        raise _scenarios(who, error) from error
    except Exception as error:
        raise _scenarios(who, error) from error


def _scenarios(who: str, error: Exception) -> ScenarioError:
    """What went wrong in a scenario's code, with its place."""
    where = traceback.extract_tb(error.__traceback__)[-1]
    return ScenarioError(
        f"the scenario {who} raised {type(error).__name__}: {error} (line {where.lineno} of {where.filename})"
    )
