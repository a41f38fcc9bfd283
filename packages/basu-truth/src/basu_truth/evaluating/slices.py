"""`slices`: divides the truth by class, distance, visible share and weather; scores ignore objects outside a slice."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, NamedTuple

from basu_truth.truth import CLASSES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from basu_truth.truth import SeenObject, Truth

DISTANCES_M = (0.0, 20.0, 40.0, 80.0, float("inf"))
VISIBLE_SHARES = (0.0, 0.4, 0.6, 0.8, 1.0)
"""As the levels of visibility of nuScenes."""
DARK_DEG = -6.0  # height of the sun at the end of civil twilight
WET_PERCENT, FOGGY_PERCENT = 20.0, 20.0  # precipitation and fog density from which a weather is called so


class Slice(NamedTuple):
    """A part of the truth. Objects that are not in it are not counted, and detections of them neither.

    Attributes:
        by: class, distance, visibility, weather, or all.
        name: of the part.
        counts: whether an object is in it.
        categories: the classes that are looked at.
        frames: the frames that are looked at; None: all.
    """

    by: str
    name: str
    counts: Callable[[SeenObject], bool]
    categories: tuple[str, ...]
    frames: frozenset[int] | None = None


def slices(truth: Truth) -> Iterator[Slice]:
    """Yield all slices of a truth; the first one is the whole."""
    present = {each.category for each in truth.objects}
    categories = tuple(name for name in CLASSES if name in present)
    yield Slice("all", "all", lambda _: True, categories)
    for name in categories:
        yield Slice("class", name, lambda _: True, (name,))
    for low, high in itertools.pairwise(DISTANCES_M):
        label = f"{low:g}-{high:g} m" if high < float("inf") else f"{low:g} m and more"
        yield Slice("distance", label, _within(_distance, low, high), categories)
    for low, high in itertools.pairwise(VISIBLE_SHARES):
        limit = float("inf") if high == VISIBLE_SHARES[-1] else high
        yield Slice("visibility", f"{100 * low:g}-{100 * high:g} %", _within(_share, low, limit), categories)
    of_weather: dict[str, set[int]] = {}
    for frame in truth.frames:
        of_weather.setdefault(weather_name(frame.weather), set()).add(frame.number)
    for label, frames in sorted(of_weather.items()):
        yield Slice("weather", label, lambda _: True, categories, frozenset(frames))


def weather_name(weather: Mapping[str, float]) -> str:
    """Return light and air of a weather in words: ``day, clear`` or ``night, rain and fog``."""
    if not weather:
        return "the map's own"
    sun_deg = weather.get("sun_altitude_angle", 90.0)
    light = "day" if sun_deg >= 0.0 else "dusk" if sun_deg > DARK_DEG else "night"
    air = ["rain"] if weather.get("precipitation", 0.0) >= WET_PERCENT else []
    air += ["fog"] if weather.get("fog_density", 0.0) >= FOGGY_PERCENT else []
    return f"{light}, {' and '.join(air) or 'clear'}"


def _within(value: Callable[[SeenObject], float], low: float, high: float) -> Callable[[SeenObject], bool]:
    return lambda seen: low <= value(seen) < high


def _distance(seen: SeenObject) -> float:
    return seen.distance_m


def _share(seen: SeenObject) -> float:
    """Return the visible share; an object without one is in no slice by visibility."""
    return -1.0 if seen.visibility is None else seen.visibility
