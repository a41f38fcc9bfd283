"""Replays a recording in the running episode: after each step the actors take their recorded poses.

The first frame after the start shows the moment asked for, and each one after it a step (times the time factor) later;
so a recording of N steps is replayed by N steps of the same length. Source of the rules: ``CarlaReplayer.cpp``.
"""

import logging
from collections import deque
from typing import NamedTuple

import numpy as np

from linden.geometry import compose
from linden.protocol.values.space import Transform
from linden.replay import frame_records as recorded_lamps
from linden.replay.apply_frame import FrameApplier
from linden.replay.file.packets import Frame, RecordingError
from linden.replay.file.track import RecordingTrack
from linden.replay.interpolation import ActorPlaces, between, places
from linden.replay.replayed_actors import ReplayedActors, ReplayedWorld, Rules

log = logging.getLogger("linden")

_SAME_MOMENT_S = 1e-6
"""Moments closer than this are one: what sums of steps differ by is far less, and no frame is so short."""


class ReplayPlan(NamedTuple):
    """What of a recording is replayed.

    ``start_s`` counts from the recording's end where it is negative. ``duration_s`` 0 is all that follows. The
    spectator follows the actor ``follow_id`` of the recording at ``offset`` to it; 0 is no actor.
    """

    start_s: float
    duration_s: float
    follow_id: int
    offset: Transform
    replay_sensors: bool


class Replayer:
    """What is being replayed, if anything.

    Attributes:
        time_factor: how many seconds of the recording pass in one of the episode.
        ignore_hero: whether the hero of the recording is left out, so that another may drive in its traffic.
        ignore_spectator: whether the spectator is left where it is.
    """

    def __init__(self) -> None:
        self.time_factor = 1.0
        self.ignore_hero = False
        self.ignore_spectator = True
        self._run: _Run | None = None

    def start(self, simulation: ReplayedWorld, track: RecordingTrack, plan: ReplayPlan) -> "Span":
        """Replay a recording from now on, in place of the one under way; closes it at the end.

        Raises:
            RecordingError: something in it cannot be; it is then closed.
        """
        self.stop(keep_actors=False)
        rules = Rules(self.ignore_hero, self.ignore_spectator, plan.replay_sensors)
        try:
            self._run = _Run(simulation, track, plan, rules)
        except RecordingError:
            track.recording.close()
            raise
        return self._run.span

    def stop(self, *, keep_actors: bool) -> None:
        """End the replay under way, if there is one: the actors stop, and physics moves them again.

        Without ``keep_actors`` the actors that the rest of the recording would remove are destroyed.
        """
        if self._run is None:
            return
        run, self._run = self._run, None
        run.end(keep_actors=keep_actors)

    def forget(self) -> None:
        """End the replay under way, as its episode is over."""
        if self._run is not None:
            self._run.recording.close()
            self._run = None

    def after_step(self, simulation: ReplayedWorld, delta_s: float) -> None:
        """Apply the poses of this frame; a recording that turns out damaged ends here, and the log says where."""
        if self._run is None:
            return
        try:
            is_over = self._run.advance(delta_s * self.time_factor)
        except (RecordingError, OSError) as error:
            log.warning("the replay ends here: %s", error)
            is_over = True
        simulation.episode.observe()  # before the end: the frame shows the recording's last moment
        if is_over:
            self.stop(keep_actors=True)


class Span(NamedTuple):
    """Which part of a recording is replayed, s since it began."""

    total_s: float
    start_s: float
    stop_s: float


class _Run:
    """A replay under way."""

    def __init__(self, simulation: ReplayedWorld, track: RecordingTrack, plan: ReplayPlan, rules: Rules) -> None:
        self.recording = track.recording
        self._simulation, self._plan = simulation, plan
        self._frames, self._elapsed_s = track.places, track.elapsed_s
        self._events = deque(sorted(track.events.items()))
        self.span = _span(float(self._elapsed_s[-1]), plan)
        self._actors = ReplayedActors(simulation, rules)
        self._applier = FrameApplier(simulation, self._actors)
        self._known: dict[int, Frame] = {}
        self._now_s = self.span.start_s
        self._has_begun = False
        self._show()

    def advance(self, delta_s: float) -> bool:
        """Show the next moment; returns whether it was the last."""
        if self._has_begun:
            self._now_s += delta_s
        self._has_begun = True
        self._show()
        return self._now_s + _SAME_MOMENT_S >= min(self.span.stop_s, self.span.total_s)

    def _show(self) -> None:
        now_s = min(self._now_s, self.span.total_s)
        at = max(0, int(np.searchsorted(self._elapsed_s, now_s + _SAME_MOMENT_S, side="right")) - 1)
        while self._events and self._events[0][0] <= at:
            self._take_in(self._events.popleft()[1])
        frame = self._frame(at)
        self._applier.put(self._places(at, now_s))
        self._applier.show(frame)
        self._follow()

    def _places(self, at: int, now_s: float) -> ActorPlaces:
        """Return the places of all actors at ``now_s``, which is in frame ``at``."""
        here = places(self._frame(at))
        since_s = now_s - float(self._elapsed_s[at])
        if since_s <= _SAME_MOMENT_S or at + 1 == len(self._frames):
            return here
        share = since_s / float(self._elapsed_s[at + 1] - self._elapsed_s[at])
        return between(here, places(self._frame(at + 1)), share)

    def _frame(self, at: int) -> Frame:
        """Return a frame; the last few are kept."""
        if at not in self._known:
            self._known = {near: frame for near, frame in self._known.items() if abs(near - at) <= 1}
            self._known[at] = self.recording.frame(self._frames[at])
        return self._known[at]

    def _take_in(self, frame: Frame | RecordingError) -> None:
        """Add and remove the actors of a frame, and switch the lamps that were switched in it.

        Raises:
            RecordingError: the frame is damaged.
        """
        if isinstance(frame, RecordingError):
            raise frame
        parent_of = dict(frame.parents.tolist())
        for actor in frame.added:
            self._actors.enter(actor, parent_of.get(actor.id, 0))
        for (actor_id,) in frame.removed.tolist():
            self._actors.leave(actor_id)
        self._applier.swing_doors(frame.doors)
        lamps = recorded_lamps.states(frame.scene_lights)
        if unknown := self._simulation.episode.surroundings.lamps.update(lamps):
            log.info("replay: the map lacks %d of the lamps that were switched", len(unknown))

    def _follow(self) -> None:
        episode = self._simulation.episode
        actor_id = self._actors.of.get(self._plan.follow_id, 0)
        if actor_id in episode.actors:
            episode.place(episode.spectator_id, compose(episode.transform(actor_id), self._plan.offset))

    def end(self, *, keep_actors: bool) -> None:
        """Give everybody back to the physics and close the recording."""
        if not keep_actors:
            for _, frame in self._events:
                for (actor_id,) in () if isinstance(frame, RecordingError) else frame.removed.tolist():
                    self._actors.leave(actor_id)
        self._actors.dismiss()
        self.recording.close()


def _span(total_s: float, plan: ReplayPlan) -> Span:
    start_s = max(0.0, total_s + plan.start_s) if plan.start_s < 0.0 else min(plan.start_s, total_s)
    return Span(total_s, start_s, start_s + plan.duration_s if plan.duration_s > 0.0 else total_s)
