"""Reports about a recording: actors that stood still, collisions.

``show_recorder_actors_blocked`` and ``show_recorder_collisions`` return them. Source of texts and number formats:
``CarlaRecorderQuery.cpp``.
"""

import math
import time
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.replay.file.layouts import SCENERY, ActorKind
from linden.replay.file.packets import Header, Records
from linden.replay.file.read import Recording


def number(value: float) -> str:
    """Return a number as a C++ stream writes it: 6 significant digits; a nan keeps its sign."""
    if math.isnan(value) and math.copysign(1.0, value) < 0.0:
        return "-nan"
    return f"{value:g}"


def triple(values: Iterable[float]) -> str:
    """Return numbers in brackets."""
    return f"({', '.join(map(number, values))})"


def heading(header: Header) -> str:
    """Return the lines that begin every report; the date is that of this machine's time zone, as in CARLA."""
    date = time.strftime("%m/%d/%y %H:%M:%S", time.localtime(header.date_unix_s))
    return f"Version: {header.version}\nMap: {header.map_name}\nDate: {date}\n\n"


def ending(last_number: int, duration: str) -> str:
    """Return the lines that end every report; ``duration`` in s, already written."""
    return f"\nFrames: {last_number}\nDuration: {duration} seconds\n"


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
    for stop in _longest_first(watch.stops()):
        name = type_ids.get(stop.actor_id, "")
        told.append(f"{stop.began_s:8.0f} {stop.actor_id:>6} {name:<35} {stop.duration_s:10.0f}\n")
    told.append(ending(number_, number(elapsed_s)))
    return "".join(told)


def _longest_first(stops: list[Stop]) -> Iterator[Stop]:
    """Yield stops by their duration, equal ones in their order.

    ``sorted`` holds Python's lock until it ends, which takes most of a second for some million stops. numpy does not.
    """
    durations_s = np.fromiter((stop.duration_s for stop in stops), np.float64, len(stops))
    for place in np.argsort(-durations_s, kind="stable").tolist():
        yield stops[place]


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
        """Return the stops that ended, then the stops that last to the end, in the order of their ends."""
        return self._ended + self._long_ones(np.arange(len(self._began_s)))


ANY, HERO, OTHER = "a", "h", "o"
ASKED_FOR = {
    "h": "hero",
    "v": "vehicles",
    "w": "walkers",
    "t": "traffic lights and signs",
    "o": "others",
    "a": "any",
}
"""Kinds of actors, as clients name them in requests for reports."""
LETTERS: dict[int, str] = {
    ActorKind.OTHER: OTHER,
    ActorKind.VEHICLE: "v",
    ActorKind.WALKER: "w",
    ActorKind.TRAFFIC_LIGHT: "t",
    ActorKind.TRAFFIC_SIGN: "t",
    ActorKind.SENSOR: OTHER,
}
"""How the report calls a kind of actor; CARLA's own table has none for signs and sensors and shows what lies behind."""


def collisions(recording: Recording, first_kind: str, second_kind: str) -> str:
    """Return the report of contacts between actors of two kinds: letters of ``ASKED_FOR``.

    A contact that lasts is reported once. After a report, the duration at the end has no decimals: CARLA's stream
    still rounds as for the times.
    """
    told = [heading(recording.header)]
    told.append(f"{'Time':>8} {'Types':>6} {'Id':>6} {'Actor 1':<35} {'Id':>6} {'Actor 2':<35}\n")
    letters, type_ids = {SCENERY: OTHER}, {SCENERY: ""}
    rows, number_, elapsed_s = 0, 0, 0.0
    lasting: set[tuple[int, int]] = set()
    for frame in recording.whole_frames():
        number_, elapsed_s = frame.number, frame.elapsed_s
        for actor in frame.added:
            letters[actor.id] = LETTERS.get(actor.kind, OTHER)
            type_ids[actor.id] = actor.description.id
        now: set[tuple[int, int]] = set()
        for _, first, second, first_is_hero, second_is_hero in frame.collisions.tolist():
            kinds = letters.get(first, OTHER), letters.get(second, OTHER)
            if not (_fits(first_kind, kinds[0], first_is_hero) and _fits(second_kind, kinds[1], second_is_hero)):
                continue
            now.add((first, second))
            if (first, second) not in lasting:
                rows += 1
                told.append(
                    f"{elapsed_s:8.0f}   {kinds[0]} {kinds[1]}  {first:>6} {type_ids.get(first, ''):<35} "
                    f"{second:>6} {type_ids.get(second, ''):<35}\n"
                )
        lasting = now
    told.append(ending(number_, f"{elapsed_s:.0f}" if rows else number(elapsed_s)))
    return "".join(told)


def _fits(wanted: str, letter: str, is_hero: int) -> bool:
    return wanted in (ANY, letter) or (wanted == HERO and bool(is_hero))
