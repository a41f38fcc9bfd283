"""`DrivenVehicles`: delays `destroy_actor` answers and frames until the Traffic Manager has dropped the vehicle.

When ``destroy_actor`` is answered, LibCarla's ``Simulator::DestroyActor`` cuts the actor off from its episode. A
Traffic Manager holds the same object. Its thread ends the process where it still works on it: "trying to operate on
a destroyed actor". It drops a car at the beginning of a step with a snapshot that lacks it. A batch without the car
shows that. In CARLA the answer comes between two frames, and a race remains. Here the answer waits for that batch, or,
where no frame comes by itself, until the thread is idle.

A snapshot without the car that comes in the middle of a step is as bad. ``EpisodeState::GetActorSnapshot`` then returns
memory that was never written, the Traffic Manager takes a speed limit from it, and the process ends in
``Map::GetNext`` ("distance > 0.0") or by a recursion without an end. So asynchronous mode's next frame waits for the
end of the step.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from linden.protocol.wire.commands import COMMANDS, DestroyActor, SpawnActor
from linden.protocol.wire.controls import Controls

BATCH = "apply_batch"
DESTROY = "destroy_actor"

PATIENCE_S = 0.25
"""How long an answer or a frame waits. A Traffic Manager without cars sends no batch any more."""
LONG_PATIENCE_S = 1.0
"""How long an answer waits where other cars are driven, so that a batch will come: on a busy machine a step is long."""

_OF_PROGRAMS = {COMMANDS.index(SpawnActor), COMMANDS.index(DestroyActor)}
"""Commands that no batch of a Traffic Manager has."""


class HeldAnswer(NamedTuple):
    """The answer to a destruction that has to wait."""

    actor_id: int
    answer: bytes
    until_s: float
    for_frame: bool
    """Whether a frame without the car will come; otherwise it is enough that the thread is idle."""


@dataclass(slots=True)
class DrivenVehicles:
    """What one client's Traffic Managers are known to drive. All times in s of one steady clock."""

    actor_ids: frozenset[int] = frozenset()
    """Those in the last batch."""
    steps: int = 0
    """Batches until the thread is idle: a step on the last frame, and one before it that may have begun earlier."""
    waiting: list[HeldAnswer] = field(default_factory=list)
    """In the order in which the cars were destroyed."""
    _until_s: float | None = None  # how long the next frame waits at most
    _last_ids: bytes = b""
    _last: frozenset[int] = frozenset()  # the same

    def shown(self) -> None:
        """Note that a frame was published: the thread begins a step, at once or after that which it is at."""
        self.steps = min(self.steps + 1, 2)

    def batch(self, commands: object) -> list[bytes]:
        """Note a batch, which ends a step, and return the answers that need not wait any longer."""
        actor_ids = self._ids_of(commands)
        if not actor_ids:
            return []
        self.actor_ids, self.steps = actor_ids, max(0, self.steps - 1)
        idle = self.steps == 0
        return self._release(
            [one for one in self.waiting if one.actor_id not in actor_ids or (idle and not one.for_frame)]
        )

    def _ids_of(self, commands: object) -> frozenset[int]:
        """Return the actors of a batch; that of a Traffic Manager names the same ones in nearly every step."""
        if not isinstance(commands, Controls):
            return _actor_ids(commands)
        packed = commands.actor_ids.tobytes()
        if packed != self._last_ids:
            self._last_ids, self._last = packed, frozenset(commands.actor_ids.tolist())
        return self._last

    def destroyed(self, actor_id: object, answer: bytes, now_s: float, *, frames_come: bool) -> bool:
        """Return whether the answer to a destruction has to wait, and keep it where it has."""
        if not isinstance(actor_id, int) or actor_id not in self.actor_ids:
            return False
        if any(one.actor_id == actor_id for one in self.waiting) or not (frames_come or self.steps):
            return False
        is_last = self.actor_ids <= {actor_id, *(one.actor_id for one in self.waiting)}
        patience_s = PATIENCE_S if is_last else LONG_PATIENCE_S
        self.waiting.append(HeldAnswer(actor_id, answer, now_s + patience_s, frames_come))
        return True

    def frame_wait_s(self, now_s: float, is_there: Callable[[int], bool]) -> float:
        """Return how long the next frame waits at most for the step on a car that is gone; 0 where it need not."""
        gone = {actor_id for actor_id in self.actor_ids if not is_there(actor_id)} if self.steps else set()
        if gone and self._until_s is None:
            self._until_s = now_s + PATIENCE_S
        if gone and self._until_s is not None and now_s < self._until_s:
            return self._until_s - now_s
        self.actor_ids -= gone
        self._until_s = None
        return 0.0

    def overdue(self, now_s: float) -> list[bytes]:
        """Return the answers that have waited long enough."""
        return self._release([one for one in self.waiting if now_s >= one.until_s])

    def _release(self, ready: list[HeldAnswer]) -> list[bytes]:
        for one in ready:
            self.waiting.remove(one)
        return [one.answer for one in ready]


def _actor_ids(commands: Any) -> frozenset[int]:  # noqa: ANN401 - as it came
    """Return the actors of a batch as it came; none where it is not a Traffic Manager's."""
    try:
        if any(command[0][0] in _OF_PROGRAMS for command in commands):
            return frozenset()
        return frozenset(command[0][1][0] for command in commands)
    except (TypeError, LookupError):
        return frozenset()
