"""The cars that a client's Traffic Managers drive, and answers to their destruction.

When ``destroy_actor`` is answered, LibCarla's ``Simulator::DestroyActor`` cuts the actor off from its episode. A
Traffic Manager holds the same object, and its thread ends the process where it still works on it: "trying to operate on
a destroyed actor". It drops a car at the beginning of a step whose snapshot lacks it, and a batch without the car says
so. In CARLA the answer comes between two frames, and a race remains. Here the answer waits for that batch, or, where no
frame comes by itself, until the batch of the last frame has come and the thread is idle.
"""

from dataclasses import dataclass, field
from typing import Any, NamedTuple

from linden.wire.plain import Controls

BATCH = "apply_batch"
DESTROY = "destroy_actor"

PATIENCE_S = 0.1
"""How long an answer waits. A Traffic Manager whose last car was destroyed sends no batch any more."""


class Waiting(NamedTuple):
    """The answer to a destruction that has to wait."""

    actor_id: int
    answer: bytes
    until_s: float


@dataclass(slots=True)
class Driven:
    """What one client's Traffic Managers are known to drive. All times in s of one steady clock."""

    actor_ids: frozenset[int] = frozenset()
    """Those in the last batch."""
    frame: int = -1
    """The world's frame when that batch came."""
    waiting: list[Waiting] = field(default_factory=list)

    def batch(self, commands: object, frame: int) -> list[bytes]:
        """Note a batch, and return the answers that need not wait any longer."""
        actor_ids = _actor_ids(commands)
        if not actor_ids:
            return []
        self.actor_ids, self.frame = actor_ids, frame
        return self._release([one for one in self.waiting if one.actor_id not in actor_ids])

    def destroyed(self, actor_id: object, answer: bytes, now_s: float, frame: int, *, frames_come: bool) -> bool:
        """Return whether the answer to a destruction has to wait, and keep it where it has."""
        if actor_id not in self.actor_ids or not isinstance(actor_id, int):
            return False
        self.actor_ids -= {actor_id}
        if not frames_come and self.frame >= frame:
            return False
        self.waiting.append(Waiting(actor_id, answer, now_s + PATIENCE_S))
        return True

    def overdue(self, now_s: float) -> list[bytes]:
        """Return the answers that have waited long enough."""
        return self._release([one for one in self.waiting if now_s >= one.until_s])

    def _release(self, ready: list[Waiting]) -> list[bytes]:
        for one in ready:
            self.waiting.remove(one)
        return [one.answer for one in ready]


def _actor_ids(commands: Any) -> frozenset[int]:  # noqa: ANN401 - as it came
    """Return the actors of a batch as it came; none where its form is not that of a Traffic Manager's."""
    if isinstance(commands, Controls):
        return frozenset(commands.actor_ids.tolist())
    try:
        return frozenset(command[0][1][0] for command in commands)
    except (TypeError, LookupError):
        return frozenset()
