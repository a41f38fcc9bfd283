"""An offline stage for tests of single nodes: a straight route to the east, and an actor on it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from py_trees.common import Status

from basu.scenarios.stage import ActorSpec, Pose
from basu.testing import OfflineStage, offline_place, steady

if TYPE_CHECKING:
    from collections.abc import Callable

    from py_trees.behaviour import Behaviour

    from basu.testing import Driver


def actor_at(
    x_m: float, y_m: float = 0.0, yaw_rad: float = 0.0, *, speed_mps: float = 0.0, kind: str = "vehicle.audi.a2"
) -> ActorSpec:
    """An actor called "other"."""
    return ActorSpec("other", kind, Pose(x_m, y_m, 0.0, yaw_rad), speed_mps=speed_mps)


def stage_with(
    *cast: ActorSpec,
    driver: Driver | None = None,
    length_m: float = 200.0,
    junctions_m: tuple[tuple[float, float], ...] = (),
    turn_share: float = 1.0,
    seed: int = 0,
) -> OfflineStage:
    """The ego begins at (0, 0) and drives east along y = 0, at 10 m/s by default."""
    place = offline_place([(0.0, 0.0), (length_m, 0.0)], junctions_m=junctions_m)
    return OfflineStage(place, cast, driver or steady(10.0), turn_share=turn_share, seed=seed)


def play(
    node: Behaviour, stage: OfflineStage, until_s: float = 60.0, watch: Callable[[OfflineStage], None] | None = None
) -> float:
    """Tick a node until it is done, and say when that was; after ``until_s`` it fails."""
    for part in node.iterate():
        part.setup(stage=stage)
    while stage.time_s <= until_s:
        node.tick_once()
        if watch is not None:
            watch(stage)
        if node.status != Status.RUNNING:
            assert node.status == Status.SUCCESS
            return stage.time_s
        stage.advance()
    raise AssertionError(f"'{node.name}' is not done after {until_s:g} s")
