"""What a station tells of itself: the contents of its cooperative awareness message.

Source of meaning: CARLA 0.9.16, CaService.cpp, and the definitions of ETSI TS 102 894-2 V1.3.1 where CARLA departs from
them. CARLA's yaw rate and lateral acceleration have the wrong sign. Its vertical acceleration contains gravity. Its
latitude and longitude are rounded to single floats. Its speed is 0 in reverse gear. Its time is the computer's.
"""

import math
from typing import NamedTuple

from linden.blueprints.library import BlueprintKind
from linden.protocol.values.enums import SemanticTag
from linden.protocol.values.space import Vector3D
from linden.protocol.values.v2x import (
    CooperativeAwarenessMessage,
    DriveDirection,
    StationType,
    VehicleFacts,
    VehicleRole,
    VehicleState,
)
from linden.sensors.devices import gnss
from linden.sensors.devices.noise import gaussian
from linden.sensors.devices.radio.spec import CamErrors
from linden.simulation.actor_table import ActorRecord

_TYPES = {
    SemanticTag.PEDESTRIANS: StationType.PEDESTRIAN,
    SemanticTag.BICYCLE: StationType.CYCLIST,
    SemanticTag.MOTORCYCLE: StationType.MOTORCYCLE,
    SemanticTag.CAR: StationType.PASSENGER_CAR,
    SemanticTag.BUS: StationType.BUS,
    SemanticTag.TRUCK: StationType.LIGHT_TRUCK,
}
_EXTERIOR_LIGHTS = {
    0x002: 0x80,  # low beam
    0x004: 0x40,  # high beam
    0x020: 0x20,  # left blinker
    0x010: 0x10,  # right blinker
    0x040: 0x04,  # reverse
    0x080: 0x02,  # fog
    0x001: 0x01,  # position, which ETSI calls parking
}
"""Bits of CARLA's VehicleLightState, and those of ETSI's ExteriorLights; CARLA has no daytime running lights."""
_BRAKE_PEDAL, _GAS_PEDAL = 0x80, 0x40


class Telling(NamedTuple):
    """What a vehicle or walker knows of itself when it sends."""

    heading_deg: float  # 0 is north, growing clockwise
    speed_mps: float  # along it, negative backwards
    acceleration_mps2: Vector3D  # forwards, to the right, upwards
    yaw_rate_radps: float  # clockwise from above
    length_m: float
    width_m: float
    brakes: bool
    accelerates: bool


def station_type(carrier: ActorRecord | None) -> StationType:
    """Return what carries a radio: a road side unit where nothing that moves by itself does."""
    if carrier is None or carrier.kind not in (BlueprintKind.VEHICLE, BlueprintKind.WALKER):
        return StationType.ROAD_SIDE_UNIT
    if carrier.description.attribute("special_type") == "emergency":
        return StationType.SPECIAL_VEHICLE
    return next((_TYPES[SemanticTag(tag)] for tag in carrier.semantic_tags if tag in _TYPES), StationType.UNKNOWN)


def vehicle_role(carrier: ActorRecord, kind: StationType) -> VehicleRole:
    """Return what a vehicle does."""
    if kind is StationType.SPECIAL_VEHICLE:
        return VehicleRole.EMERGENCY
    if carrier.description.attribute("special_type") == "taxi":
        return VehicleRole.TAXI
    return VehicleRole.PUBLIC_TRANSPORT if kind is StationType.BUS else VehicleRole.DEFAULT


def vehicle_facts(carrier: ActorRecord, kind: StationType) -> VehicleFacts:
    """Return the low-frequency container."""
    lights = sum(bit for lamp, bit in _EXTERIOR_LIGHTS.items() if carrier.light_state & lamp)
    return VehicleFacts(vehicle_role(carrier, kind), lights)


class Place(NamedTuple):
    """Which station tells, when and where."""

    station_id: int
    kind: StationType
    now_s: float
    location: Vector3D  # of the station in the world, m
    origin_deg: tuple[float, float]  # latitude and longitude of the map's origin


def awareness(
    place: Place, telling: Telling | None, facts: VehicleFacts | None, errors: CamErrors, number: int
) -> CooperativeAwarenessMessage:
    """Return message ``number`` of a station; a road side unit has nothing to tell but its place."""
    position = gnss.measure(errors.position, number, place.location, place.origin_deg)
    return CooperativeAwarenessMessage(
        station_id=place.station_id,
        station_type=place.kind,
        generation_delta_time=round(place.now_s * 1000.0) % 65_536,
        latitude=_within(position.latitude * 1e7, -900_000_000, 900_000_000),
        longitude=_within(position.longitude * 1e7, -1_800_000_000, 1_800_000_000),
        altitude=_within(position.altitude * 100.0, -100_000, 800_000),
        state=None if telling is None else _state(telling, errors, number),
        facts=facts,
    )


def _state(telling: Telling, errors: CamErrors, number: int) -> VehicleState:
    deviations = (
        errors.heading_deviation_deg,
        errors.speed_deviation_mps,
        *errors.acceleration_deviation_mps2,
        errors.yaw_rate_deviation_radps,
    )
    heading, speed, *acceleration, yaw_rate = gaussian(errors.position.seed, number, deviations)
    forwards, right, upwards = (
        part + error for part, error in zip(telling.acceleration_mps2, acceleration, strict=True)
    )
    heading_deg = telling.heading_deg + errors.heading_bias_deg + heading
    speed_mps = telling.speed_mps + speed
    left_degps = -math.degrees(telling.yaw_rate_radps + errors.yaw_rate_bias_radps + yaw_rate)
    backward = round(speed_mps * 100.0) < 0
    return VehicleState(
        heading=round(heading_deg * 10.0) % 3600,
        heading_confidence=_confidence(errors.heading_deviation_deg * 10.0),
        speed=_within(abs(speed_mps) * 100.0, 0, 16_382),
        speed_confidence=_confidence(errors.speed_deviation_mps * 100.0),
        drive_direction=DriveDirection.BACKWARD if backward else DriveDirection.FORWARD,
        length=_within(telling.length_m * 10.0, 1, 1022),
        width=_within(telling.width_m * 10.0, 1, 61),
        longitudinal_acceleration=_within(forwards * 10.0, -160, 160),
        lateral_acceleration=_within(-right * 10.0, -160, 160),
        vertical_acceleration=_within(upwards * 10.0, -160, 160),
        yaw_rate=_within(left_degps * 100.0, -32_766, 32_766),
        acceleration_control=_BRAKE_PEDAL * telling.brakes | _GAS_PEDAL * telling.accelerates,
    )


def _confidence(deviation: float) -> int:
    """Return half the width of the interval that holds 95 % of the readings, 1 to 125, or 126 beyond."""
    return min(126, max(1, math.ceil(1.96 * deviation)))


def _within(value: float, least: int, most: int) -> int:
    return min(most, max(least, round(value)))
