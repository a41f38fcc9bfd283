"""Plays a scenario without a server, with simple drivers for the ego, and returns what happened."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from py_trees.common import Status

from basu.scenarios.actions.path_follower import gap_ahead
from basu.scenarios.paths import Path
from basu.scenarios.scenario import compose, set_on
from basu.scenarios.stage import EGO
from basu.testing.offline_stage import OfflineStage

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray
    from py_trees.behaviour import Behaviour

    from basu.scenarios.scenario import Composed, Scenario
    from basu.scenarios.stage import ActorBox
    from basu.testing.offline_stage import StageCommand


Driver = Callable[[OfflineStage], float]
START_MPS2 = 2.0  # how hard they accelerate


def steady(speed_mps: float) -> Driver:
    """One speed from the first frame on, regardless of obstacles."""
    return lambda _stage: speed_mps


def waiting_at(
    s_m: float, seconds: float, speed_mps: float, brake_mps2: float = 2.0, start_mps2: float = START_MPS2
) -> Driver:
    """A speed, a lawful stop before ``s_m`` of the route for so long, and on."""
    stood_s = 0.0

    def drive(stage: OfflineStage) -> float:
        nonlocal stood_s
        now_mps, left_m = stage.ego.forward_mps, s_m - stage.ego_s_m
        if stood_s >= seconds or left_m < -0.5:
            return min(speed_mps, now_mps + start_mps2 * stage.step_s)
        wanted_mps = min(speed_mps, math.sqrt(2.0 * brake_mps2 * max(left_m - 0.3, 0.0)))
        if wanted_mps < 0.3:
            stood_s += stage.step_s
            return 0.0
        return min(wanted_mps, now_mps + start_mps2 * stage.step_s)

    return drive


def careful(speed_mps: float, brake_mps2: float = 5.0, keeps_m: float = 3.0) -> Driver:
    """A speed, and braking for actors on its way, to stand ``keeps_m`` before them."""
    way: Path | None = None

    def drive(stage: OfflineStage) -> float:
        nonlocal way
        way = way or Path.through(stage.route.points_m)
        now_mps, allowed_mps = stage.ego.forward_mps, speed_mps
        for name in stage.names:
            is_passed = name == EGO or name in stage.rolled_over
            ahead = None if is_passed else gap_ahead(way, stage.ego_s_m, stage.ego, stage.body(name))
            if ahead is not None:
                room_m = max(0.0, ahead.gap_m - keeps_m)
                allowed_mps = min(allowed_mps, math.sqrt(ahead.speed_mps**2 + 2.0 * 0.6 * brake_mps2 * room_m))
        lowest_mps = now_mps - brake_mps2 * stage.step_s
        return max(0.0, lowest_mps, min(allowed_mps, now_mps + START_MPS2 * stage.step_s))

    return drive


EGO_MPS = 6.0  # as fast as the shuttle's agents drive


@dataclass(frozen=True, slots=True, kw_only=True)
class Rehearsal:
    """What happened."""

    tree: Composed  # as it was left
    phases_s: dict[str, float]  # when each phase began; one that was never reached is missing
    contacts_s: dict[str, float]  # when the ego first touched each actor
    times_s: NDArray[np.float64]  # (T,) of the frames
    ego_s_m: NDArray[np.float64]  # (T,) along its route
    trails: dict[str, NDArray[np.float64]]  # by role (T, 4): x, y in m, yaw in rad, speed in m/s; nan while not there
    commands: tuple[StageCommand, ...]
    spans_s: dict[Behaviour, tuple[float, float | None]]  # when each node of the tree began and ended; None: not ended

    @property
    def over(self) -> bool:
        """Whether all phases were passed."""
        return bool(self.tree.root.root.status == Status.SUCCESS)

    def least_distance_m(self, name: str) -> float:
        """The least distance from the ego's middle to an actor's."""
        apart_m = self.trails[name][:, :2] - self.trails[EGO][:, :2]
        return float(np.nanmin(np.hypot(*apart_m.T)))


def rehearse(
    scenario: Scenario,
    driver: Driver | None = None,
    *,
    seed: int = 0,
    step_s: float = 0.05,
    until_s: float | None = None,
    turn_share: float = 1.0,
) -> Rehearsal:
    """Play it until its tree is done, at most as long as its time limit; the ego drives 6 m/s by default."""
    stage = OfflineStage(
        scenario.place, scenario.actors(), driver or steady(EGO_MPS), seed=seed, step_s=step_s, turn_share=turn_share
    )
    tree = compose(scenario)
    set_on(tree, stage)
    phases_s: dict[str, float] = {}
    contacts_s: dict[str, float] = {}
    spans_s: dict[Behaviour, tuple[float, float | None]] = {}
    nodes = list(tree.root.root.iterate())
    frames: list[tuple[float, float, dict[str, ActorBox]]] = []
    for _ in range(1 + round((until_s or scenario.timeout_s) / step_s)):
        frames.append((stage.time_s, stage.ego_s_m, {name: stage.body(name) for name in stage.names}))
        tree.root.tick()
        for phase, node in tree.phases.items():
            if node.status != Status.INVALID:
                phases_s.setdefault(phase, stage.time_s)
        _note_spans(nodes, spans_s, stage.time_s)
        for name in sorted(stage.ego_contacts):
            contacts_s.setdefault(name, stage.time_s)
        if tree.root.root.status in (Status.SUCCESS, Status.FAILURE):
            break
        stage.advance()
    return Rehearsal(
        tree=tree,
        phases_s=phases_s,
        contacts_s=contacts_s,
        times_s=np.array([frame[0] for frame in frames]),
        ego_s_m=np.array([frame[1] for frame in frames]),
        trails=_trails([frame[2] for frame in frames]),
        commands=tuple(stage.commands),
        spans_s=spans_s,
    )


def _note_spans(nodes: Sequence[Behaviour], spans_s: dict[Behaviour, tuple[float, float | None]], now_s: float) -> None:
    """Note which nodes have begun or ended in this frame."""
    for node in nodes:
        if node.status == Status.RUNNING:
            spans_s.setdefault(node, (now_s, None))
        elif node.status != Status.INVALID or node in spans_s:
            began_s, ended_s = spans_s.get(node, (now_s, None))
            spans_s[node] = began_s, now_s if ended_s is None else ended_s


def _trails(frames: list[dict[str, ActorBox]]) -> dict[str, NDArray[np.float64]]:
    """By role, a row a frame."""
    away = (np.nan,) * 4

    def row(body: ActorBox | None) -> tuple[float, ...]:
        return away if body is None else (body.x_m, body.y_m, body.yaw_rad, body.speed_mps)

    return {name: np.array([row(frame.get(name)) for frame in frames]) for name in frames[0]}
