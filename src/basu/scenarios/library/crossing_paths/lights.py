"""Traffic lights of the junction ahead: green for the ego, red for all others."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu.errors import ScenarioError
from basu.routing import ControlKind
from basu.scenarios.actions import SetLight, Together

if TYPE_CHECKING:
    from basu.scenarios.place import Place

LIGHT = "1000001"  # the OpenDRIVE type of a signal for motor traffic
ONE_JUNCTION_M = 45.0  # lights this near to one another belong together


def green_for_ego(place: Place) -> Together:
    """The ego's next light is green and stays so; everybody else's at that junction is red.

    Raises:
        ScenarioError: no light lies ahead on the route.
    """
    ahead = [c for c in place.route.controls if c.kind is ControlKind.TRAFFIC_LIGHT and c.s_m >= place.trigger_s_m]
    if not ahead:
        raise ScenarioError("no traffic light lies ahead on the ego's route; the case belongs before one")
    own = ahead[0]
    theirs = sorted(
        {  # a light is listed once more for each connecting road that refers to it
            landmark.id
            for landmark in place.carla_map.get_all_landmarks_of_type(LIGHT)
            if landmark.id != own.landmark_id
            and _away_m(landmark.transform.location, own.x_m, own.y_m) < ONE_JUNCTION_M
        }
    )
    lights = [SetLight(own.landmark_id, "Green"), *(SetLight(landmark_id, "Red") for landmark_id in theirs)]
    return Together(*lights, name="green for the ego")


def has_light(place: Place) -> bool:
    """Whether a light lies ahead on the route."""
    return any(c.kind is ControlKind.TRAFFIC_LIGHT and c.s_m >= place.trigger_s_m for c in place.route.controls)


def _away_m(location: object, x_m: float, y_m: float) -> float:
    return math.hypot(location.x - x_m, location.y - y_m)  # type: ignore[attr-defined]
