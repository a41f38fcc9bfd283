"""`EpisodeSpec`, an episode before its world is loaded: town, route, vehicle, weather, traffic, scenarios, scoring."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import carla

from basu.agents.autonomous_agent import AgentConfig
from basu.conditions import NO_TRAFFIC, STEP_S, Sumo, Traffic
from basu.metrics.scoring import Scoring
from basu.routing.route_file import RouteDescription, RoutePoint
from basu.routing.weather import changed
from basu.scenarios.paths.lanes import followed, waypoint_at

if TYPE_CHECKING:
    from basu.routing.weather import WeatherMark
    from basu.scenarios.playable import Playable
    from basu.scenarios.scenario import Scenario

POINT_M = 20.0  # between the points of a route that goes straight on
JUNCTION_WITHIN_M, BEHIND_JUNCTION_M = 250.0, 30  # such a route goes on to behind a junction, where that is needed

Describe = Callable[[carla.Map], RouteDescription]


@dataclass(frozen=True, slots=True, kw_only=True)
class EpisodeSpec:
    """An episode before there is a world for it."""

    town: str
    route: RouteDescription | Describe  # a function where the route's points depend on the map
    config: AgentConfig = field(default_factory=AgentConfig)  # its vehicle is the one under test
    weather: carla.WeatherParameters  # at the start
    weather_along: tuple[WeatherMark, ...] = ()  # along the route
    traffic: Traffic = NO_TRAFFIC
    sumo: Sumo | None = None  # traffic of SUMO
    scenarios: tuple[Playable, ...] = ()  # on the route, or the one case
    is_case: bool = False  # the episode begins and ends with its one scenario
    reload: bool | None = None  # whether the world begins anew; None: see ``Towns.load``
    scoring: Scoring = field(default_factory=Scoring)
    lane_invasions: bool = True  # the client takes 0.4 s of each new world to get ready for them
    step_s: float = STEP_S
    timeout_s: float = 20.0  # of wall time to wait for the simulator
    stop_after_s: float | None = None  # of simulated time; None: the drive goes on to its own end

    def description(self, carla_map: carla.Map) -> RouteDescription:
        """The route's description on this map.

        Raises:
            UserError: the route has no place there.
        """
        return self.route if isinstance(self.route, RouteDescription) else self.route(carla_map)


def case_spec(playable: Playable, *, vehicle: str | None = None, timeout_s: float = 20.0) -> EpisodeSpec:
    """The episode of one case by itself; ``vehicle`` replaces the case's own."""
    return EpisodeSpec(
        town=playable.case.town,
        route=lambda carla_map: description_of(playable, carla_map),
        config=AgentConfig(vehicle=vehicle or playable.case.ego.model),
        weather=_weather(playable),
        scenarios=(playable,),
        is_case=True,
        reload=True,
        lane_invasions=False,  # no criterion reads them
        timeout_s=timeout_s,
    )


def description_of(playable: Playable, carla_map: carla.Map) -> RouteDescription:
    """The ego's route in a case: through the points that the case gives, or straight on along the lanes.

    Raises:
        UserError: no road lies where it begins.
    """
    case = playable.case
    start = case.ego.pose
    points = [RoutePoint(start.x_m, start.y_m, start.z_m, start.yaw_rad)]
    if case.way:
        points += [RoutePoint(pose.x_m, pose.y_m, pose.z_m) for pose in case.way]
    else:
        way = _straight_on(waypoint_at(carla_map, start), playable.scenario)
        places = [waypoint.transform.location for waypoint in [*way[int(POINT_M) :: int(POINT_M)], way[-1]]]
        points += [RoutePoint(at.x, at.y, at.z) for at in places]
    return RouteDescription(id=case.name, town=case.town, points=tuple(points), stops=case.stops, source=case.source)


def _straight_on(start: carla.Waypoint, scenario: type[Scenario]) -> list[carla.Waypoint]:
    """A waypoint a metre, as far as the scenario needs: ScenarioRunner's cases name no end."""
    if not scenario.needs_junction:
        return followed(start, scenario.needs_m)
    way = followed(start, max(JUNCTION_WITHIN_M, scenario.needs_m))
    inside = [waypoint.is_junction for waypoint in way]
    entry = inside.index(True) if True in inside else len(way)
    behind = inside.index(False, entry) if False in inside[entry:] else len(way)
    return way[: 1 + max(math.ceil(scenario.needs_m), behind + BEHIND_JUNCTION_M)]


def _weather(playable: Playable) -> carla.WeatherParameters:
    """The weather of a case, else of its scenario, as changes of CARLA's clear noon."""
    given = playable.scenario.weather if playable.case.weather is None else playable.case.weather
    noon = carla.WeatherParameters.ClearNoon
    fresh = carla.WeatherParameters(
        **{name: getattr(noon, name) for name in ("sun_azimuth_angle", "sun_altitude_angle")}
    )
    return changed(fresh, given)
