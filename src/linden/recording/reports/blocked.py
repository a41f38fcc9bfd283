"""``show_recorder_actors_blocked``: who stood where for long. Source: ``CarlaRecorderQuery.cpp``."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.recording.packets import Records
from linden.recording.read import Recording
from linden.recording.reports.wording import ending, heading, number


class Stop(NamedTuple):
    """A time during which an actor did not get on, s."""

    began_s: float
    actor_id: int
    duration_s: float


def blocked(recording: Recording, min_time_s: float, min_distance_cm: float) -> str:
    """Return the report of actors that moved less than ``min_distance_cm`` for ``min_time_s`` or longer, longest first.

    As in CARLA the last frame counts for -1 s, which is the duration that stands in it.
    """
    watch = _Watch(min_time_s, min_distance_cm)
    type_ids: dict[int, str] = {}
    number_, elapsed_s = 0, 0.0
    for frame in recording.whole_frames():
        number_, elapsed_s = frame.number, frame.elapsed_s
        type_ids.update((actor.id, actor.description.id) for actor in frame.added)
        watch.see(frame.positions, elapsed_s, frame.duration_s)
    told = [heading(recording.header), f"{'Time':>8} {'Id':>6} {'Actor':<35} {'Duration':>10}\n"]
    for stop in sorted(watch.stops(), key=lambda stop: -stop.duration_s):
        name = type_ids.get(stop.actor_id, "")
        told.append(f"{stop.began_s:8.0f} {stop.actor_id:>6} {name:<35} {stop.duration_s:10.0f}\n")
    told.append(ending(number_, number(elapsed_s)))
    return "".join(told)


class _Watch:
    """Keeps an eye on everybody at once: columns with a place for each actor that was ever seen."""

    def __init__(self, min_time_s: float, min_distance_cm: float) -> None:
        self._min_time_s, self._min_distance_cm = min_time_s, min_distance_cm
        self._place_of: dict[int, int] = {}
        self._ids: NDArray[np.uint32] = np.zeros(0, np.uint32)
        self._places: NDArray[np.int64] = np.zeros(0, np.int64)
        self._last_cm: NDArray[np.float32] = np.zeros((0, 3), np.float32)
        self._began_s: NDArray[np.float64] = np.zeros(0)
        self._duration_s: NDArray[np.float64] = np.zeros(0)
        self._ended: list[Stop] = []

    def see(self, positions: Records, elapsed_s: float, duration_s: float) -> None:
        """Take in one frame."""
        if not np.array_equal(positions["id"], self._ids):
            self._seat(positions["id"])
        at, here_cm = self._places, positions["location_cm"]
        apart_cm = np.sqrt(np.square(here_cm - self._last_cm[at]).sum(axis=1))
        still = apart_cm < self._min_distance_cm
        begins = at[still & (self._duration_s[at] == 0.0)]
        self._began_s[begins] = elapsed_s
        self._duration_s[at[still]] += duration_s
        moving = at[~still]
        self._ended += self._long_ones(moving)
        self._duration_s[moving] = 0.0
        self._last_cm[moving] = here_cm[~still]

    def _seat(self, ids: NDArray[np.uint32]) -> None:
        for actor_id in ids.tolist():
            self._place_of.setdefault(actor_id, len(self._place_of))
        more = len(self._place_of) - len(self._began_s)
        self._last_cm = np.concatenate([self._last_cm, np.zeros((more, 3), np.float32)])
        self._began_s, self._duration_s = (np.append(old, np.zeros(more)) for old in (self._began_s, self._duration_s))
        self._ids = ids.copy()
        self._places = np.array([self._place_of[actor_id] for actor_id in ids.tolist()], np.int64)

    def _long_ones(self, places: NDArray[np.int64]) -> list[Stop]:
        long_enough = places[self._duration_s[places] >= self._min_time_s]
        if not len(long_enough):
            return []
        ids = list(self._place_of)
        return [Stop(float(self._began_s[at]), ids[at], float(self._duration_s[at])) for at in long_enough.tolist()]

    def stops(self) -> list[Stop]:
        """Return the stops that ended, then those that last to the end, in the order of their ends."""
        return self._ended + self._long_ones(np.arange(len(self._began_s)))
