"""Placing of a scenario on a route: trigger point, room left, behaviour tree; exceptions become `ScenarioError`.

On the way of a longer route a scenario's part ends ``needs_m`` behind its trigger point: there the ego has "arrived"
as far as the scenario is concerned.
"""

from __future__ import annotations

import math
import traceback
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import carla
import numpy as np

from basu.errors import BasuError, ScenarioError, SimulatorError
from basu.routing.planned_route import Progress, advance, until
from basu.scenarios.place import Place
from basu.scenarios.scenario import compose

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import TypeVar

    T = TypeVar("T")
    from basu.routing import Route
    from basu.scenarios.playable import Playable
    from basu.scenarios.scenario import Composed, Scenario
    from basu.scenarios.stage import ActorSpec, Pose
    from basu.scenarios.xml_elements import GivenActor


def call_scenario(name: str, call: Callable[[], T]) -> T:
    """One call of a scenario's code; what goes wrong in it is the scenario's.

    Raises:
        ScenarioError: it raised.
        SimulatorError: the simulator did not answer it.
    """
    try:
        return call()
    except BasuError:
        raise
    except RuntimeError as error:
        if "time-out" in str(error):
            raise SimulatorError(f"the simulator failed in the scenario {name}: {error}") from error
        raise _scenarios(name, error) from error
    except Exception as error:
        raise _scenarios(name, error) from error


def _scenarios(name: str, error: Exception) -> ScenarioError:
    """What went wrong in a scenario's code, with its place."""
    where = traceback.extract_tb(error.__traceback__)[-1]
    return ScenarioError(
        f"the scenario {name} raised {type(error).__name__}: {error} (line {where.lineno} of {where.filename})"
    )


OFF_ROUTE_M = 5.0  # a trigger point farther than this from the route belongs to another way
ALIKE_M = 1.0  # places of the route so much farther from a point than its nearest one may be meant as well
TURNED_RAD = math.radians(60.0)  # a trigger point turned by more than this looks along another way
IN_THE_WAY_M = 2.5  # aside of the route, within which an actor stands in the ego's way


class PlacedScenario(NamedTuple):
    """A scenario on its route."""

    planned: Playable
    scenario: Scenario
    composed: Composed
    way: Route  # up to where the scenario's own part ends


def place_scenario(planned: Playable, route: Route, carla_map: carla.Map, *, own: bool) -> PlacedScenario:
    """Lay a scenario on the ego's route, which is ``own`` or has others on it.

    Raises:
        ScenarioError: its trigger point lies off the route, too little of the route is left behind it, or its own code
            finds that it has no place there.
    """
    case = planned.case
    place = Place(
        route=route,
        trigger_s_m=_trigger_s_m(planned, route, own=own),
        carla_map=carla_map,
        others=tuple(_on_the_ground(other, carla_map) for other in case.others),
    )
    way = route
    if not own:
        needs_m = planned.scenario.needs_m
        if place.left_m < needs_m:
            raise ScenarioError(
                f"{case.source}: '{case.name}' ({case.type}) needs {needs_m:.0f} m of the route behind its trigger "
                f"point, and there are {place.left_m:.0f} m; move it back or let the route go on"
            )
        way = until(route, place.trigger_s_m + needs_m)
    scenario = call_scenario(case.name, partial(planned.scenario, place, planned.values))
    return PlacedScenario(planned, scenario, call_scenario(case.name, partial(compose, scenario)), way)


def _on_the_ground(other: GivenActor, carla_map: carla.Map) -> GivenActor:
    """Return an ``<other_actor>`` at the height of the road next to it, where its file gives none."""
    if other.pose.z_m:
        return other
    at = carla.Location(other.pose.x_m, other.pose.y_m, 0.0)
    road = carla_map.get_waypoint(at, project_to_road=True, lane_type=carla.LaneType.Any)
    if road is None:
        return other
    return replace(other, pose=other.pose._replace(z_m=float(road.transform.location.z)))


def _trigger_s_m(planned: Playable, route: Route, *, own: bool) -> float:
    """How far along the route a scenario begins."""
    case = planned.case
    if case.trigger is None:
        return 0.0
    if own:
        return nearest_s_m(route, case.trigger.x_m, case.trigger.y_m)
    return _on_the_way_s_m(planned, route, case.trigger)


def _on_the_way_s_m(planned: Playable, route: Route, trigger: Pose) -> float:
    """Where the route first comes by a trigger point in its direction.

    Raises:
        ScenarioError: it does not.
    """
    case = planned.case
    point = f"{case.source}: the trigger point of '{case.name}' ({trigger.x_m:.1f}, {trigger.y_m:.1f})"
    away_m = np.hypot(route.points_m[:, 0] - trigger.x_m, route.points_m[:, 1] - trigger.y_m)
    nearest_m = float(away_m.min())
    if nearest_m > OFF_ROUTE_M:
        raise ScenarioError(
            f"{point} lies {nearest_m:.1f} m off the route '{route.id}'; move it to within {OFF_ROUTE_M:.0f} m"
        )
    along = np.cos(route.yaw_rad - trigger.yaw_rad) >= math.cos(TURNED_RAD)
    candidates = np.flatnonzero(along & (away_m <= OFF_ROUTE_M))
    if not len(candidates):
        index = int(away_m.argmin())
        raise ScenarioError(
            f"{point} looks to {round(math.degrees(trigger.yaw_rad)) % 360}°, and the route goes to "
            f"{round(math.degrees(float(route.yaw_rad[index]))) % 360}° there; turn it"
        )
    least_m = float(away_m[candidates].min())
    first = int(candidates[away_m[candidates] <= least_m + ALIKE_M][0])
    near = Progress(float(route.s_m[first]), 0.0, 0.0)
    return float(advance(route, near, trigger.x_m, trigger.y_m).s_m)


def nearest_s_m(route: Route, x_m: float, y_m: float) -> float:
    """How far along a route its point nearest to a place is."""
    away2 = (route.points_m[:, 0] - x_m) ** 2 + (route.points_m[:, 1] - y_m) ** 2
    return float(advance(route, Progress(float(route.s_m[int(away2.argmin())]), 0.0, 0.0), x_m, y_m).s_m)


def is_behind(place: Place, spec: ActorSpec) -> bool:
    """Whether an actor stands in the ego's lane before the trigger point, where the ego would reach it from behind."""
    s_m = nearest_s_m(place.route, spec.pose.x_m, spec.pose.y_m)
    at = place.at(s_m - place.trigger_s_m)
    aside_m = math.hypot(spec.pose.x_m - at.x_m, spec.pose.y_m - at.y_m)
    return s_m < place.trigger_s_m and aside_m < IN_THE_WAY_M
