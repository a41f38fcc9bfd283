"""The criterion of no collision with actors or things."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu.metrics.collisions import beginnings
from basu.scenarios.criteria.criterion import Criterion
from basu.thresholds import AT_REST_MPS

if TYPE_CHECKING:
    from collections.abc import Collection

    from basu.records.history import Collision
    from basu.scenarios.criteria.criterion import Judgement, Played

TOLD = 3  # contacts that the sentence tells of one by one


class NoCollision(Criterion):
    """The ego touches no actor and no thing.

    ``except_with`` names roles that may be touched. Where ``standing_counts`` is False, a contact in which the ego
    stood (below 0.1 m/s in the frame before) is reported and does not count, as in the leaderboard 2.x. Messages of
    the sensor are brought together into contacts as ``basu.metrics.collisions`` does.
    """

    name = "no collision"

    def __init__(
        self, *, except_with: Collection[str] = (), standing_counts: bool = True, deciding: bool = True
    ) -> None:
        super().__init__(deciding=deciding)
        self.except_with, self.standing_counts = frozenset(except_with), standing_counts

    def judge(self, played: Played) -> Judgement:
        """The first contact that counts decides; the figure is the ego's speed in the frame before it."""
        history = played.history
        speed_mps = history.speed_mps()
        begun = [event for event in beginnings(history, {}) if played.roles.get(event.other_id) not in self.except_with]
        before_mps = [float(speed_mps[max(0, event.tick - 1)]) for event in begun]
        counting = [index for index in range(len(begun)) if self.standing_counts or before_mps[index] >= AT_REST_MPS]
        said = [_sentence(played, event, mps) for event, mps in zip(begun, before_mps, strict=True)]
        more = f"; and {len(said) - TOLD} more" if len(said) > TOLD else ""
        sentence = "; ".join(said[:TOLD]) + more
        if not counting:
            return self.says(played, True, sentence or "it touched no actor and no thing", unit="m/s", limit="none")
        event = begun[counting[0]]
        return self.says(
            played,
            False,
            sentence,
            tick=event.tick,
            measured=before_mps[counting[0]],
            unit="m/s",
            limit="none",
            other=played.roles.get(event.other_id, event.other_type),
        )


def _sentence(played: Played, event: Collision, before_mps: float) -> str:
    """The other party, the time, the ego's speed, and the other's speed where the record has it."""
    history = played.history
    role = played.roles.get(event.other_id)
    other = event.other_type if role is None else f"{role} ({event.other_type})"
    near = history.others[(history.others["id"] == event.other_id) & (history.others["tick"] == max(0, event.tick - 1))]
    theirs = ""
    if event.other_id and len(near):
        their_mps = math.hypot(float(near[0]["velocity_x_mps"]), float(near[0]["velocity_y_mps"]))
        theirs = f", which had {their_mps:.2f} m/s,"
    t_s = float(history.frames["t_s"][event.tick])
    verb = "was touched by" if before_mps < AT_REST_MPS else "hit"
    return (
        f"{verb} {other}{theirs} at {t_s:.2f} s at {before_mps:.2f} m/s "
        f"with an impulse of {math.hypot(*event.impulse_ns):.0f} N s"
    )
