"""Characteristics of a case: those of table 3.1 of the thesis, and the partner that a driver has to see.

Atmosphere, lighting and surface follow from the case's weather. The partner, which a driver has to see to pass, follows
from the class, or from the value that chooses the partner's blueprint. The rest is known from the scenario's class, or
stated by the case: ``<characteristics alignment="curve" obstruction="vehicle"/>``. What they state of the place and of
the others is compared with the map and with rehearsals of all cases by a test. A played
case also has figures of its route and drive (`measured`). Driver characteristics of the table, such as age, have no
meaning here.
"""

from __future__ import annotations

import difflib
import enum
import math
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, get_type_hints

import numpy as np

from basu.errors import ScenarioError
from basu.records.partners import Partner, partner_of
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import narrowed

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from basu.records.history import History
    from basu.scenarios.scenario import Scenario
    from basu.scenarios.xml_elements import Case

WEATHER_OF_CASE = "of the case"  # the name of the weather of a drive without --weather
TWILIGHT_DEG = -6.0  # civil twilight: the sun's centre is up to 6 degrees below the horizon
WET_PERCENT, FOG_PERCENT, CLOUDY_PERCENT = 20.0, 15.0, 50.0  # of carla.WeatherParameters, from there on
BEND_RAD_PER_M = 1.0 / 100.0  # a radius of 100 m and less
GRADE = 0.03  # 3 %, from there on a road is not level


class Atmosphere(enum.Enum):
    """Atmospheric conditions."""

    CLEAR = "clear"
    CLOUDY = "cloudy"
    RAIN = "rain"
    FOG = "fog"


class Lighting(enum.Enum):
    """Light of the sun."""

    DAYLIGHT = "daylight"
    DUSK = "dusk"
    DARK = "dark"


class Surface(enum.Enum):
    """Roadway surface conditions."""

    DRY = "dry"
    WET = "wet"
    SLIPPERY = "slippery"


class Alignment(enum.Enum):
    """Roadway alignment where the conflict is."""

    STRAIGHT = "straight"
    CURVE = "curve"


class JunctionRelation(enum.Enum):
    """Relation to a junction; an approach begins 60 m before one."""

    NONE = "none"
    APPROACH = "approach"
    INTERSECTION = "intersection"
    ROUNDABOUT = "roundabout"


class TrafficControl(enum.Enum):
    """Traffic control device on the ego's way at the conflict."""

    NONE = "none"
    STOP_SIGN = "stop-sign"
    YIELD_SIGN = "yield-sign"
    TRAFFIC_LIGHT = "traffic-light"


class Obstruction(enum.Enum):
    """What obscures the view of the conflict partner."""

    NONE = "none"
    VEHICLE = "vehicle"


class Highway(enum.Enum):
    """Highway occurrence: whether 45 mph and more are posted at the conflict."""

    NO = "no"
    YES = "yes"


class OtherSpeeding(enum.Enum):
    """Whether another vehicle is more than 1 m/s faster than the posted limit."""

    NO = "no"
    YES = "yes"


class Violation(enum.Enum):
    """The rule that another road user breaks; that of the ego is judged and not chosen."""

    NONE = "none"
    RED_LIGHT = "red-light"
    STOP_SIGN = "stop-sign"
    RIGHT_OF_WAY = "right-of-way"
    LANE_CHANGE = "lane-change"
    WRONG_SIDE = "wrong-side"
    DOOR = "door"


@dataclass(frozen=True, slots=True, kw_only=True)
class Characteristics:
    """The characteristics of one case."""

    atmosphere: Atmosphere = Atmosphere.CLEAR
    lighting: Lighting = Lighting.DAYLIGHT
    surface: Surface = Surface.DRY
    alignment: Alignment = Alignment.STRAIGHT
    junction: JunctionRelation = JunctionRelation.NONE
    control: TrafficControl = TrafficControl.NONE
    obstruction: Obstruction = Obstruction.NONE
    partner: Partner = Partner.VEHICLE
    highway: Highway = Highway.NO
    speeding: OtherSpeeding = OtherSpeeding.NO
    violation: Violation = Violation.NONE

    def among(self, wanted: Mapping[str, Sequence[enum.Enum]]) -> bool:
        """Whether each field that is ``wanted`` has one of its values there."""
        return all(getattr(self, field) in values for field, values in wanted.items())

    def document(self) -> dict[str, str]:
        """The values by field."""
        return {name: value.value for name, value in asdict(self).items()}


KINDS: dict[str, type[enum.Enum]] = get_type_hints(Characteristics)
"""The values of each field."""

_AT_STOP_SIGN = {"junction": "intersection", "control": "stop-sign"}
OF_SCENARIO: dict[str, Mapping[str, str]] = {  # by class, where they differ from the defaults
    "ControlLoss": {"surface": "slippery", "partner": "none"},
    "SlipperyStop": {"surface": "slippery", "junction": "approach", "control": "stop-sign", "partner": "sign"},
    "BendDeparture": {"surface": "slippery", "alignment": "curve", "partner": "none"},
    "CrossWind": {"partner": "none"},
    "SteeringDeviation": {"partner": "none"},
    "RunningForTheShuttle": {"partner": "walker"},
    "OccludedChild": {"obstruction": "vehicle"},
    "DynamicObject": {"obstruction": "vehicle"},
    "LeadVehicleSwerves": {"obstruction": "vehicle"},
    "PedestrianTurn": {"junction": "intersection"},
    "CyclistAtRightTurn": {"junction": "intersection"},
    "CyclistCrossing": {"junction": "intersection"},
    "BackingCar": {"violation": "right-of-way"},
    "CutInAtTtc": {"violation": "lane-change"},
    "Dooring": {"violation": "door"},
    "DriftingNeighbour": {"violation": "lane-change"},
    "NarrowedStreet": {"violation": "wrong-side"},
    "OncomingOvertaker": {"violation": "wrong-side"},
    "ParkedCarPullsOut": {"violation": "right-of-way"},
    "StrayingOncoming": {"violation": "wrong-side"},
    "CutInBeforeStop": {"junction": "approach", "control": "stop-sign", "violation": "lane-change"},
    "RightHook": {"junction": "approach", "violation": "lane-change"},
    "FollowLeadingVehicle": {"junction": "approach", "control": "stop-sign"},
    "FollowLeadingVehicleWithObstacle": {"junction": "approach"},
    "CarAcrossJunction": {"junction": "intersection", "violation": "right-of-way"},
    "EgoTurnsLeft": {"junction": "intersection"},
    "LeftTurnAcrossPath": {"junction": "intersection", "violation": "right-of-way"},
    "RedLightRunner": {"junction": "intersection", "control": "traffic-light", "violation": "red-light"},
    "RightTurnIntoPath": {"junction": "intersection", "violation": "right-of-way"},
    "Roundabout": {"junction": "roundabout", "control": "yield-sign", "alignment": "curve"},
    "StopSignRunner": {"junction": "intersection", "violation": "stop-sign"},
    "StraightCrossingPaths": _AT_STOP_SIGN,
    "TurnIntoTraffic": _AT_STOP_SIGN,
    "UnsignalizedIntersection": _AT_STOP_SIGN,
}


OF_GROUP = {  # the partner in a group's scenarios; in the others a vehicle
    Group.ANIMAL: Partner.ANIMAL,
    Group.PEDESTRIAN: Partner.WALKER,
    Group.PEDALCYCLIST: Partner.CYCLIST,
}


def characteristics_of(case: Case, scenario: type[Scenario]) -> Characteristics:
    """The characteristics of a case: of its weather, its class and its own statement, the later before the earlier.

    Raises:
        ScenarioError: the class or the case states a field or a value that does not exist.
    """
    weather = scenario.weather if case.weather is None else case.weather
    stated = {
        "partner": _partner(case, scenario).value,
        **OF_SCENARIO.get(scenario.__name__, {}),
        **scenario.characteristics,
        **case.characteristics,
    }
    values: dict[str, Any] = {**_of_weather(weather), **{name: value_of(name, text) for name, text in stated.items()}}
    return Characteristics(**values)


def _partner(case: Case, scenario: type[Scenario]) -> Partner:
    """The partner by the value that chooses its blueprint, else by the group."""
    if scenario.partner_choice is None:
        return OF_GROUP.get(scenario.group, Partner.VEHICLE)
    name, blueprints = scenario.partner_choice
    parameters, given = narrowed(scenario.parameters, case.values)
    default = next(str(parameter.unsaid) for parameter in parameters if parameter.name == name)
    return partner_of(blueprints.get(given.get(name, default), ""))


def value_of(field: str, text: str) -> enum.Enum:
    """A field's value from its text.

    Raises:
        ScenarioError: there is no such field, or it has no such value.
    """
    if field not in KINDS:
        raise ScenarioError(f"there is no characteristic '{field}'; {_meant(field, KINDS)}")
    values = {value.value: value for value in KINDS[field]}
    if text not in values:
        raise ScenarioError(f"{field} has no value '{text}'; {_meant(text, values)}")
    return values[text]


def read_where(conditions: Iterable[tuple[str, str]]) -> dict[str, list[enum.Enum]]:
    """The requested values by field; a field that is given several times allows each of its values.

    Raises:
        ScenarioError: there is no such field, or it has no such value.
    """
    wanted: dict[str, list[enum.Enum]] = {}
    for field, text in conditions:
        wanted.setdefault(field, []).append(value_of(field, text))
    return wanted


def measured(history: History, first_tick: int) -> dict[str, Any]:
    """Figures of a played case where its conflict began: posted speed, travel speed, grade, and whether in a bend."""
    route = history.facts.route
    s_m = float(history.frames["route_s_m"][first_tick])
    at = min(int(np.searchsorted(route.s_m, s_m)), len(route.s_m) - 1)
    limit_mps = float(route.speed_limit_mps[at])
    ahead = (route.s_m >= s_m) & (route.s_m <= s_m + 50.0) & ~route.is_junction
    bend = np.abs(np.gradient(np.unwrap(route.yaw_rad), route.s_m)) if len(route.s_m) > 1 else np.zeros(1)
    rise = np.gradient(route.points_m[:, 2], route.s_m) if len(route.s_m) > 1 else np.zeros(1)
    return {
        "posted_mps": limit_mps if math.isfinite(limit_mps) else None,
        "travel_mps": round(float(history.speed_mps()[first_tick]), 3),
        "in_bend": bool((bend[ahead] >= BEND_RAD_PER_M).any()),
        "level": bool((np.abs(rise[ahead]) < GRADE).all()),
    }


def _of_weather(weather: Mapping[str, float]) -> dict[str, enum.Enum]:
    """What follows from the fields of carla.WeatherParameters; without them, CARLA's clear noon."""
    rain = weather.get("precipitation", 0.0)
    sun_deg = weather.get("sun_altitude_angle", 45.0)
    if rain > 0.0:
        atmosphere = Atmosphere.RAIN
    elif weather.get("fog_density", 0.0) >= FOG_PERCENT:
        atmosphere = Atmosphere.FOG
    else:
        atmosphere = Atmosphere.CLOUDY if weather.get("cloudiness", 0.0) >= CLOUDY_PERCENT else Atmosphere.CLEAR
    wet = max(rain, weather.get("wetness", 0.0), weather.get("precipitation_deposits", 0.0)) >= WET_PERCENT
    lighting = Lighting.DARK if sun_deg < TWILIGHT_DEG else Lighting.DUSK if sun_deg < 0.0 else Lighting.DAYLIGHT
    return {"atmosphere": atmosphere, "lighting": lighting, "surface": Surface.WET if wet else Surface.DRY}


def _meant(name: str, known: Iterable[str]) -> str:
    """What may have been meant."""
    names = list(known)
    close = difflib.get_close_matches(name, names, 1)
    return f"did you mean '{close[0]}'?" if close else f"it may be {', '.join(names)}"
