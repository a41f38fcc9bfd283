"""Weather with some of its fields changed."""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING

from basu.errors import ScenarioError
from basu.routing.route_weather import WEATHER_FIELDS

if TYPE_CHECKING:
    from collections.abc import Mapping

    import carla


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
