"""Surrogate measures of safety as criteria: least distance, time to collision, post-encroachment time, headway.

The first three are reported of every case, whether its scenario asks for them or not (`reported_always`).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.boxes import other_boxes, own_boxes, touching
from basu.metrics.passengers.near_misses import CROSSING_RAD, post_encroachment_s, times_to_collision_s
from basu.scenarios.criteria.margin import Margin
from basu.thresholds import AT_REST_MPS, IN_MOTION_MPS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from basu.metrics.boxes import Boxes
    from basu.records.history import History
    from basu.scenarios.criteria.criterion import Criterion, Judgement
    from basu.scenarios.criteria.margin import Present


CORNERS = np.array([(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)])


def gap_m(a: Boxes, b: Boxes) -> NDArray[np.float64]:
    """(N,) from each box to its partner, 0 where they touch.

    Two convex shapes apart are nearest at a corner of one of them, so the corners of each against the other box are all
    there is to look at: 16 clamped differences a pair.
    """
    apart_m = np.minimum(_corners_to(a, b), _corners_to(b, a))
    return np.where(touching(a, b), 0.0, apart_m)


def _corners_to(a: Boxes, b: Boxes) -> NDArray[np.float64]:
    """(N,) the least distance from the corners of each ``a`` to its ``b``."""
    corners = a[:, None, :2] + _turned(CORNERS[None] * a[:, None, 3:], a[:, 2])  # (N, 4, 2)
    within = _turned(corners - b[:, None, :2], -b[:, 2])
    beyond = np.maximum(np.abs(within) - b[:, None, 3:], 0.0)
    least: NDArray[np.float64] = np.hypot(beyond[..., 0], beyond[..., 1]).min(axis=1)
    return least


def _turned(points: NDArray[np.float64], yaw_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 4, 2) points turned by an angle each."""
    cos, sin = np.cos(yaw_rad)[:, None], np.sin(yaw_rad)[:, None]
    x, y = points[..., 0], points[..., 1]
    return np.stack([x * cos - y * sin, x * sin + y * cos], axis=-1)


class LeastDistance(Margin):
    """The ego's box stays ``at_least`` m away from the boxes of others, seen from above.

    With ``while_moving`` only frames count in which the ego moved: the ego did nothing to a party that comes close
    to it at rest. The rest is as for every `Margin`.
    """

    called = "least distance"
    unit = "m"

    def __init__(
        self,
        at_least: float | None = None,
        *,
        to: str | None = None,
        since: str | None = None,
        while_moving: bool = False,
        deciding: bool = True,
    ) -> None:
        super().__init__(at_least, to=to, since=since, deciding=deciding)
        self.while_moving = while_moving

    def frames(self, present: Present) -> NDArray[np.bool_]:
        """All, or those in which the ego moved."""
        speed_mps = present.history.speed_mps()
        return np.asarray(speed_mps > AT_REST_MPS) if self.while_moving else np.ones(len(speed_mps), dtype=np.bool_)

    def measure(self, present: Present, rows: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Between the boxes in each row's frame."""
        history = present.history
        others = history.others[rows]
        own = own_boxes(history.facts, history.frames)[others["tick"]]
        return gap_m(own, other_boxes(history.facts, others)), others["tick"].astype(np.int64)

    def words(self, value: float) -> str:
        """How far away."""
        return f"was {value:.2f} m away"


HORIZON_S = 5.0


def ego_moves(history: History) -> NDArray[np.bool_]:
    """(T,) the frames in which a time to collision counts as a near miss: the ego is not at a creep."""
    return np.asarray(history.speed_mps() > IN_MOTION_MPS)


class LeastTtc(Margin):
    """The time to collision stays at ``at_least`` s or more.

    Hayward 1972, by oriented boxes, as ``basu.metrics.passengers.near_misses`` has it: each frame, both are moved on
    with the speeds they have, the ego on its present bend, the other straight ahead, until their boxes touch. It is
    measured up to 5 s. Two standing actors are in no danger. With ``while_moving`` only the frames of the policy
    count, in which the ego is faster than 0.5 m/s.
    """

    called = "least time to collision"
    unit = "s"
    horizon = HORIZON_S

    def __init__(
        self,
        at_least: float | None = None,
        *,
        to: str | None = None,
        since: str | None = None,
        while_moving: bool = False,
        deciding: bool = True,
    ) -> None:
        super().__init__(at_least, to=to, since=since, deciding=deciding)
        self.while_moving = while_moving

    def frames(self, present: Present) -> NDArray[np.bool_]:
        """All, or those in which the ego counts as moving."""
        return ego_moves(present.history) if self.while_moving else super().frames(present)

    def measure(self, present: Present, rows: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """From each row's frame on."""
        history = present.history
        own, others = own_boxes(history.facts, history.frames), other_boxes(history.facts, history.others)
        found_s = times_to_collision_s(history, own, others, HORIZON_S)[rows]
        return found_s, history.others["tick"][rows].astype(np.int64)

    def words(self, value: float) -> str:
        """How long until both would have touched."""
        return f"was {value:.2f} s from a collision"


PET_HORIZON_S = 5.0  # with which the Surrogate Safety Assessment Model screens


class Pet(Margin):
    """The post-encroachment time stays at ``at_least`` s or more.

    Allen, Shin and Cooper 1978, over the places that both boxes swept: the least over all of them, as the Surrogate
    Safety Assessment Model (FHWA-HRT-08-051) takes it, to a frame. Only where the ways cross at 30 degrees or more,
    since a follower in a lane takes the same places all the time. It is measured up to 5 s; the reported frame is that
    in which the second of the two came to the place.
    """

    called = "post-encroachment time"
    unit = "s"
    horizon = PET_HORIZON_S

    def measure(self, present: Present, rows: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """From each row's place to the ego's being there, before or after."""
        history = present.history
        own, others = own_boxes(history.facts, history.frames), other_boxes(history.facts, history.others)
        found_s, later = post_encroachment_s(history, own, others, PET_HORIZON_S)
        return found_s[rows], later[rows]

    def touched(self, present: Present, rows: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Only actors that crossed the ego's way, neither those hit from behind nor standing ones."""
        history = present.history
        others = history.others[rows]
        came = history.others[
            np.hypot(history.others["velocity_x_mps"], history.others["velocity_y_mps"]) > AT_REST_MPS
        ]
        just_before = set(zip((came["tick"] + 1).tolist(), came["id"].tolist(), strict=True))
        pairs = zip(others["tick"].tolist(), others["id"].tolist(), strict=True)
        moving = np.array([pair in just_before for pair in pairs], dtype=np.bool_)
        off_rad = others["yaw_rad"] - history.frames["yaw_rad"][others["tick"]]
        crossing = np.asarray(np.abs(np.sin(off_rad)) >= math.sin(CROSSING_RAD), dtype=np.bool_)
        return super().touched(present, rows) & crossing & moving

    def never(self) -> str:
        """That no way was crossed."""
        return f"no actor crossed its way within {self.horizon:g} s"

    def words(self, value: float) -> str:
        """How long between the two."""
        return f"and the ego took the same place {value:.2f} s apart"


HEADWAY_HORIZON_S = 10.0
DRIVING_MPS = 3.0  # below this a queue moves up, and seconds say little
SAME_WAY_RAD = math.radians(45.0)


class KeepsHeadway(Margin):
    """The time gap to the vehicle ahead stays at ``at_least`` s or more.

    From the ego's front bumper to the leader's rear along the ego's heading, over the ego's speed (the time gap of ISO
    15622). Ahead is an actor that overlaps the ego's width and heads the same way within 45 degrees. Frames count in
    which the ego drives faster than 3 m/s.
    """

    called = "headway"
    unit = "s"
    horizon = HEADWAY_HORIZON_S

    def frames(self, present: Present) -> NDArray[np.bool_]:
        """Those in which the ego drives."""
        return np.asarray(present.history.speed_mps() > DRIVING_MPS)

    def measure(self, present: Present, rows: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """In each row's frame; inf for an actor that is not ahead."""
        history = present.history
        rows_of = history.others[rows]
        ticks = rows_of["tick"].astype(np.int64)
        own, others = own_boxes(history.facts, history.frames)[ticks], other_boxes(history.facts, rows_of)
        cos, sin = np.cos(own[:, 2]), np.sin(own[:, 2])
        dx_m, dy_m = (others[:, :2] - own[:, :2]).T
        turned = np.abs(np.cos(others[:, 2] - own[:, 2])), np.abs(np.sin(others[:, 2] - own[:, 2]))
        reach_m = others[:, 3] * turned[0] + others[:, 4] * turned[1]
        aside_m = others[:, 3] * turned[1] + others[:, 4] * turned[0]
        ahead_m = dx_m * cos + dy_m * sin - own[:, 3] - reach_m
        beside = np.abs(dy_m * cos - dx_m * sin) >= own[:, 4] + aside_m
        same_way = np.cos(others[:, 2] - own[:, 2]) >= math.cos(SAME_WAY_RAD)
        time_s = ahead_m / history.speed_mps()[ticks]
        return np.where((ahead_m >= 0.0) & ~beside & same_way & (time_s <= HEADWAY_HORIZON_S), time_s, np.inf), ticks

    def words(self, value: float) -> str:
        """How long behind."""
        return f"was {value:.2f} s ahead"


MARGINS: dict[str, type[Margin]] = {"distance_m": LeastDistance, "ttc_s": LeastTtc, "pet_s": Pet}
REPORTED: tuple[Callable[[], Margin], ...] = (LeastDistance, functools.partial(LeastTtc, while_moving=True), Pet)


def reported_always(criteria: Sequence[Criterion] = ()) -> tuple[Criterion, ...]:
    """The three margins to all actors, not deciding, without the ones that ``criteria`` already hold.

    The time to collision is that of the policy: both take it in the same frames.
    """
    names = {criterion.name for criterion in criteria}
    return tuple(margin() for margin in REPORTED if margin().name not in names)


def margins_of(judgements: Sequence[Judgement]) -> dict[str, float | None]:
    """How narrowly: the least figure of each margin, by the keys of ``MARGINS``; None where no actor was near."""
    return {
        key: min(
            (
                judgement.measured
                for judgement in judgements
                if judgement.measured is not None and _is_of(margin, judgement.criterion)
            ),
            default=None,
        )
        for key, margin in MARGINS.items()
    }


def _is_of(margin: type[Margin], name: str) -> bool:
    """Whether a criterion's name is this margin's, to all actors or to one."""
    return name == margin.called or name.startswith(f"{margin.called} to ")
