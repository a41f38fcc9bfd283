"""`AnswerOrder`: holds back calls and answers for long work, sensors, loads, Traffic Managers or slow subscribers.

========================================  =====================================  =============================
what waits                                for what                               how long at most
========================================  =====================================  =============================
a call with long work                     that work, in the background           ``rpc.registry``
an answer, but for a Traffic Manager's    the scene that sensors look at         :data:`SCENE_S`
a load's answer, then the calls of        the client's new episode               ``load_answers``
Traffic Managers
the next calls of the client that loads   the first frame of the new episode     :meth:`AnswerOrder.must_wait`
a tick's answer, with Traffic Managers    their thread, which goes to sleep      ``cue``
an answer to a driven car's destruction   a batch without the car                ``driven_vehicles``
any call                                  the client, which reads its answers    :data:`UNREAD_ANSWERS_BYTES`
a call that makes a frame                 slow and expected subscribers, and     ``subscribers``
                                          the scene where one looks at it
========================================  =====================================  =============================

A call that waits is the first of its client's. Only the answers of ``driven_vehicles`` go out after later ones. Calls
of other clients wait for none of this.
"""

from collections.abc import Callable
from dataclasses import dataclass

from linden.protocol.wire.rpc import Call
from linden.server.cue import QUESTION, TICK, Cue
from linden.server.driven_vehicles import BATCH, DESTROY, DrivenVehicles
from linden.server.load_answers import GATHERING_S, LOAD, LoadAnswers, Phase
from linden.server.peers import RpcPeer
from linden.server.rpc import registry
from linden.server.rpc.context import Context
from linden.server.rpc.registry import SuspendedCall
from linden.server.subscribers import Expected, Subscribers

CALLS_PER_TURN = 256
"""Calls of one client before the others have their turn: a scene's worth of controls, some ms."""
UNREAD_ANSWERS_BYTES = 1024 * 1024
"""A client that leaves more than this unread is not listened to until it has caught up."""

SCENE_S = 0.8
"""How long an answer waits at most for the sensor scene. So the calls before a first picture wait a little each, and
the tick does not wait all the time. CARLA's examples give a call two seconds. Two calls may wait in line: the
program's own and the Traffic Manager's."""

OF_TRAFFIC = frozenset(
    (
        QUESTION,
        "get_actor_bounding_box",
        "get_vehicle_light_states",
        "get_weather_parameters",
        "set_actor_simulate_physics",
        "get_traffic_light_state",
        "set_traffic_light_state",
    )
)
"""What a Traffic Manager's thread calls in a step, but for its batch."""


@dataclass(slots=True)
class _Waits:
    """What one client's calls and answers wait for; None where they do not."""

    work: SuspendedCall | None = None
    scene: tuple[bytes, float] | None = None
    """The answer, and until when it waits at most."""
    load: LoadAnswers | None = None
    cue: Cue | None = None
    driven: DrivenVehicles | None = None

    def until_s(self) -> float | None:
        """Return until when the first answer waits at most; None where none does, or where long work is done first."""
        ticks = self.cue is not None and bool(self.cue.tick)
        if not ticks and self.scene is None and self.load is None and not (self.driven and self.driven.waiting):
            return None
        times = [one.until_s for one in self.driven.waiting] if self.driven is not None else []
        if self.scene is not None:
            times.append(self.scene[1])
        if self.load is not None:
            times.append(self.load.until_s)
        if self.cue is not None and self.cue.tick:
            times.append(self.cue.deadline_s)
        return min(times, default=None)


class AnswerOrder:
    """The waiting calls and answers of all clients.

    Attributes:
        expected: the streams that clients are about to subscribe to.
    """

    def __init__(self, context: Context, subscribers: Subscribers, clock: Callable[[], float]) -> None:
        self._context = context
        self._subscribers = subscribers
        self._clock = clock
        self.expected = Expected()
        self._of: dict[RpcPeer, _Waits] = {}  # of clients of which something has waited

    def forget(self, peer: RpcPeer) -> None:
        """Drop what a client that has gone waited for, and end its long work."""
        waits = self._of.pop(peer, None)
        if waits is not None and waits.work is not None:
            waits.work.give_up()
        self.expected.forget(peer.number)

    # -- before a call -------------------------------------------------------------------------------------------

    def must_wait(self, peer: RpcPeer, unsent_bytes: int = 0) -> bool:
        """Return whether a client's next call can neither be carried out nor answered yet.

        The client that loads learns of the new episode when all others do, by its first frame. By calls alone it would
        be earlier by as long as that frame waits for Traffic Managers. Its program would go on, and another client's
        would still have the old episode.
        """
        if self._context.unshown_load == peer.number and not self.is_synchronous():
            return True
        waits = self._of.get(peer)
        is_held = None if waits is None else self._is_held(peer, waits)
        if is_held is not None:
            return is_held
        if peer.outgoing.waiting_bytes + unsent_bytes > UNREAD_ANSWERS_BYTES:
            return True
        if not registry.advances(peer.calls[0]):
            return False
        return self.waits_for_subscribers(peer) or self._context.waits_for_the_scene()

    def _is_held(self, peer: RpcPeer, waits: _Waits) -> bool | None:
        """Return whether a client's call or answer waits on; None where there is none that has begun to wait."""
        if waits.work is not None:
            return not waits.work.made.done()
        if waits.scene is not None:
            return self._context.builds_the_scene() and self._clock() < waits.scene[1]
        if waits.load is not None:
            return waits.load.waits(peer, self._clock())
        if waits.cue is not None and waits.cue.tick:
            return waits.cue.waits(peer, self._clock())
        return None

    def waits_for_subscribers(self, peer: RpcPeer) -> bool:
        """Return whether a client's next call makes a frame, while a slow or an expected subscriber is not ready."""
        waits = self._of.get(peer)
        return (
            (waits is None or waits.work is None)
            and registry.advances(peer.calls[0])
            and self.is_synchronous()
            and self.frame_wait_s(self._clock()) is not None
        )

    def frame_wait_s(self, now_s: float) -> float | None:
        """Return how long synchronous mode's next frame waits at most for slow and expected subscribers."""
        waits = (self._subscribers.patience_s(now_s), self.expected.wait_s(now_s))
        return min((wait_s for wait_s in waits if wait_s is not None), default=None)

    def held_s(self, now_s: float) -> float | None:
        """Return how long the first of the waiting answers waits at most; None for none."""
        times = [until_s for waits in self._of.values() if (until_s := waits.until_s()) is not None]
        return max(0.0, min(times) - now_s) if times else None

    def hears(self, peer: RpcPeer) -> bool:
        """Return whether to read on from a client although calls of its wait: for a call, or for the client's end."""
        waits = self._of.get(peer)
        if waits is None or len(peer.calls) >= CALLS_PER_TURN:
            return False
        return waits.work is not None or waits.load is not None or (waits.cue is not None and bool(waits.cue.tick))

    def has_long_work(self, peer: RpcPeer) -> bool:
        """Return whether a client's call waits for work in the background."""
        waits = self._of.get(peer)
        return waits is not None and waits.work is not None

    def is_synchronous(self) -> bool:
        """Return whether frames are made by calls alone."""
        return self._context.world.settings.synchronous_mode

    # -- answers that have waited --------------------------------------------------------------------------------

    def cue_of(self, peer: RpcPeer) -> Cue | None:
        """Return the cue where the client's next call is a tick that waits, or a tick or question beside traffic."""
        waits = self._of.get(peer)
        if waits is not None and waits.cue is not None and waits.cue.tick:
            return waits.cue
        if peer.calls[0].method not in (QUESTION, TICK) or not self.is_synchronous() or not self._managers(peer):
            return None
        waits = self._waits(peer)
        if waits.cue is None:
            waits.cue = Cue()
        return waits.cue

    def kept(self, peer: RpcPeer) -> bytes | None:
        """Return the answer to a client's next call that waited for the scene or as a load; None where none did."""
        waits = self._of.get(peer)
        if waits is None:
            return None
        if waits.scene is not None:
            answer, waits.scene = waits.scene[0], None
            return answer
        return None if waits.load is None else self._hand_over(peer, waits, waits.load)

    def _hand_over(self, peer: RpcPeer, waits: _Waits, load: LoadAnswers) -> bytes | None:
        """Return the answer to a load that is due, None where the client's next call has to be carried out."""
        if load.phase is Phase.GATHERING:
            return load.answered(self._clock())
        if load.phase is Phase.SETTLING or not load.bring_forward(peer, self._clock()):
            waits.load = None
        return None

    def resumed(self, peer: RpcPeer) -> SuspendedCall | None:
        """Return the client's call with long work that is done, which waits no more; None where there is none."""
        waits = self._of.get(peer)
        if waits is None or waits.work is None:
            return None
        work, waits.work = waits.work, None
        return work

    def overdue(self, now_s: float) -> list[tuple[RpcPeer, bytes]]:
        """Return the answers to destructions that no Traffic Manager has confirmed in time."""
        found = []
        for peer, waits in self._of.items():
            if waits.driven is not None and waits.driven.waiting and (ready := waits.driven.overdue(now_s)):
                found.append((peer, b"".join(ready)))
        return found

    # -- behind a call -------------------------------------------------------------------------------------------

    def suspend(self, peer: RpcPeer, work: SuspendedCall) -> None:
        """Let a client's next call wait for its long work."""
        self._waits(peer).work = work

    def keep(self, peer: RpcPeer, call: Call, answer: bytes) -> bool:
        """Return whether an answer has to wait, and keep it where it has; the call stays its client's first."""
        method = call.method
        if method == TICK and (cue := self.cue_of(peer)) is not None:
            cue.ticked(answer, self._clock())
        elif method == LOAD and (threads := self._managers(peer)):
            self._waits(peer).load = LoadAnswers(answer, threads, self._clock() + GATHERING_S)
        elif self._context.builds_the_scene() and self._leads_to_a_picture(peer, call):
            self._waits(peer).scene = answer, self._clock() + SCENE_S
        else:
            return False
        return True

    def _leads_to_a_picture(self, peer: RpcPeer, call: Call) -> bool:
        """Return whether an answer may wait for the scene.

        A Traffic Manager's calls may not: its first step makes two for each car, and would take seconds. Cars that are
        destroyed meanwhile end the client's process.
        """
        if call.is_async or registry.advances(call):
            return False
        if not self._managers(peer):
            return True
        return self.is_synchronous() and call.method not in OF_TRAFFIC

    def sent_with(self, peer: RpcPeer, call: Call, answer: bytes) -> bytes | None:
        """Return what goes out for a call that is done: its answer with the answers that it sets free, or nothing yet.

        Only cars that a Traffic Manager of the client drives make a difference; see ``driven_vehicles``.
        """
        if call.method == BATCH and call.args and self._managers(peer):
            waits = self._waits(peer)
            if waits.driven is None:
                waits.driven = DrivenVehicles()
            return b"".join((answer, *waits.driven.batch(call.args[0])))
        if call.method != DESTROY or call.is_async or not call.args or not self._managers(peer):
            return answer
        driven = self._waits(peer).driven
        if driven is None:
            return answer
        frames_come = not self.is_synchronous() and not self._context.waits_for_the_scene()
        waits_on = driven.destroyed(call.args[0], answer, self._clock(), frames_come=frames_come)
        self._context.frame_is_due |= waits_on
        return None if waits_on else answer

    # -- frames --------------------------------------------------------------------------------------------------

    def traffic_wait_s(self, now_s: float) -> float:
        """Return how long asynchronous mode's next frame waits at most for Traffic Managers; 0 where it need not.

        A frame that lacks a car must not come while a Traffic Manager works on the car; see ``driven_vehicles``.
        """
        is_there = self._context.world.episode.actors.__contains__
        driven = [waits.driven for waits in self._of.values() if waits.driven is not None]
        return max((one.frame_wait_s(now_s, is_there) for one in driven), default=0.0)

    def shown(self) -> None:
        """Note that a frame was published."""
        for waits in self._of.values():
            if waits.driven is not None:
                waits.driven.shown()

    def _waits(self, peer: RpcPeer) -> _Waits:
        waits = self._of.get(peer)
        if waits is None:
            waits = self._of[peer] = _Waits()
        return waits

    def _managers(self, peer: RpcPeer) -> int:
        """Return how many Traffic Managers a client runs."""
        count = 0
        for _, owner in self._context.traffic_managers.values():
            count += owner == peer.number
        return count
