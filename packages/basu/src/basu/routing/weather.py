"""Weather by fields: given at shares of a route, in proportion in between, or changed in some fields.

Two spellings: ``<weathers><weather route_percentage="0" cloudiness="5" …/>…</weathers>`` (leaderboard 2.x) and a single
``<weather cloudiness="5" …/>`` below ``<route>`` (leaderboard 1.0). What is not said is as in the leaderboard.
"""

from __future__ import annotations

import difflib
import itertools
import math
from typing import TYPE_CHECKING, NamedTuple

from basu.errors import ScenarioError, UserError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    import carla
    from lxml import etree


WEATHER_FIELDS = (
    "cloudiness",
    "precipitation",
    "precipitation_deposits",
    "wind_intensity",
    "sun_azimuth_angle",
    "sun_altitude_angle",
    "fog_density",
    "fog_distance",
    "fog_falloff",
    "wetness",
    "scattering_intensity",
    "mie_scattering_scale",
    "rayleigh_scattering_scale",
    "dust_storm",
)
"""Of ``carla.WeatherParameters``, in its units (per cent, degrees, m)."""

UNSAID = {"cloudiness": 50.0, "sun_altitude_angle": 70.0, "rayleigh_scattering_scale": 0.0331}
"""What the leaderboard 2.x begins from (``RouteParser.parse_weather``); the rest is 0, as in CARLA's constructor."""

SHARE = "route_percentage"
IGNORED = frozenset({SHARE, "id"})  # a name that some files give their weathers


class WeatherMark(NamedTuple):
    """The weather at a share of the way; one value for each of ``WEATHER_FIELDS``."""

    percent: float
    values: tuple[float, ...]


def read_weather(route: etree._Element, path: Path) -> tuple[WeatherMark, ...]:
    """Return the weather of a ``<route>``, its marks in the order of the way; empty where it gives none.

    Raises:
        UserError: a field that weather does not have, a value that is no number, or two marks at one share.
    """
    holder = route.find("weathers")
    elements = route.findall("weather") if holder is None else holder.findall("weather")
    marks = sorted(_mark(element, path) for element in elements)
    for before, after in itertools.pairwise(marks):
        if before.percent == after.percent:
            raise UserError(
                f"route file {path}, line {route.sourceline}: route '{route.get('id')}' has two weathers at "
                f"{SHARE} {before.percent:g}; give each its own"
            )
    return tuple(marks)


def weather_at(marks: Sequence[WeatherMark], percent: float) -> Mapping[str, float]:
    """Return the weather so far along the way: before the first and after the last mark, theirs."""
    after = next((mark for mark in marks if mark.percent >= percent), marks[-1])
    before = next((mark for mark in reversed(marks) if mark.percent <= percent), marks[0])
    span = after.percent - before.percent
    share = 0.0 if span <= 0.0 else (percent - before.percent) / span
    values = (a + (b - a) * share for a, b in zip(before.values, after.values, strict=True))
    return dict(zip(WEATHER_FIELDS, values, strict=True))


def _mark(element: etree._Element, path: Path) -> WeatherMark:
    """Read one ``<weather>`` of a route."""
    where = f"route file {path}, line {element.sourceline}: <weather>"
    given = {}
    for name, text in ((str(key), str(value)) for key, value in element.attrib.items()):
        try:
            value = 0.0 if name == "id" else float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise UserError(f"{where} has {name}='{text}', which is no number")
        if name not in WEATHER_FIELDS and name not in IGNORED:
            close = difflib.get_close_matches(name, WEATHER_FIELDS, 1)
            hint = f"did you mean '{close[0]}'?" if close else f"it may have {', '.join(WEATHER_FIELDS)}"
            raise UserError(f"{where} has the attribute '{name}', which weather does not have; {hint}")
        given[name] = value
    percent = given.get(SHARE, 0.0)
    if not 0.0 <= percent <= 100.0:
        raise UserError(f"{where} has {SHARE} {percent:g}; it must be within 0 and 100")
    return WeatherMark(percent, tuple(given.get(name, UNSAID.get(name, 0.0)) for name in WEATHER_FIELDS))


def changed(weather: carla.WeatherParameters, values: Mapping[str, float]) -> carla.WeatherParameters:
    """``weather`` with some of its fields changed, in place.

    Raises:
        ScenarioError: weather has no such field.
    """
    for name, value in values.items():
        if name not in WEATHER_FIELDS:
            close = difflib.get_close_matches(name, WEATHER_FIELDS, 1)
            hint = f"did you mean '{close[0]}'?" if close else f"it has {', '.join(WEATHER_FIELDS)}"
            raise ScenarioError(f"weather has no '{name}'; {hint}")
        setattr(weather, name, value)
    return weather
