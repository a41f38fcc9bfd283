"""Records of drives that never took place, for claims about metrics: a straight road east, a vehicle on it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from basu.records.history import FRAME, Collision, Facts, History, LaneInvasion, Recorder, Vehicle
from basu.records.history.model import NO_LIGHT
from basu.routing import ControlKind, Route, RouteControl, Stop

STEP_S = 0.05
DRIVING = 2  # carla.LaneType
VEHICLE = Vehicle(type_id="vehicle.easymile.ez10", front_m=2.0, rear_m=2.0, width_m=2.0)


def straight_route(
    length_m: float = 200.0,
    limit_mps: float = 11.0,
    controls: tuple[RouteControl, ...] = (),
    stops: tuple[Stop, ...] = (),
) -> Route:
    """A point a metre, from the origin to the east."""
    s_m = np.arange(0.0, length_m + 0.5)
    count = len(s_m)
    return Route(
        id="straight",
        town="Nowhere",
        points_m=np.column_stack([s_m, np.zeros(count), np.zeros(count)]),
        s_m=s_m,
        yaw_rad=np.zeros(count),
        lane_width_m=np.full(count, 3.5),
        speed_limit_mps=np.full(count, limit_mps),
        is_junction=np.zeros(count, dtype=np.bool_),
        road_id=np.ones(count, dtype=np.int64),
        lane_id=np.full(count, -1, dtype=np.int64),
        stops=stops,
        controls=controls,
    )


def stop_sign(s_m: float, landmark_id: str = "7") -> RouteControl:
    """A stop sign whose line lies across the straight road."""
    return RouteControl(
        kind=ControlKind.STOP_SIGN, landmark_id=landmark_id, s_m=s_m, x_m=s_m, y_m=0.0, z_m=0.0, yaw_rad=0.0
    )


def traffic_light(s_m: float, landmark_id: str = "12") -> RouteControl:
    """A traffic light whose line lies across the straight road."""
    return replace(stop_sign(s_m, landmark_id), kind=ControlKind.TRAFFIC_LIGHT)


def driven(
    speeds_mps: Sequence[float],
    *,
    route: Route | None = None,
    start_m: float = 0.0,
    lateral_m: float = 0.0,
    limit_mps: float = 0.0,
    collisions: Sequence[Collision] = (),
    lane_invasions: Sequence[LaneInvasion] = (),
) -> History:
    """The record of driving east at these speeds, one a tick; ``limit_mps`` is what the simulator posts."""
    recorder = Recorder()
    x_m = start_m
    for tick, speed_mps in enumerate(speeds_mps):
        values = {
            "tick": tick,
            "t_s": tick * STEP_S,
            "x_m": x_m,
            "y_m": lateral_m,
            "velocity_x_mps": speed_mps,
            "speed_limit_mps": limit_mps,
            "traffic_light_state": NO_LIGHT,
            "route_s_m": x_m,
            "lateral_m": lateral_m,
            "route_light": NO_LIGHT,
            "road_id": 1,
            "lane_id": -1,
            "lane_type": DRIVING,
            "lane_offset_m": lateral_m,
            "lane_width_m": 3.5,
        }
        recorder.frame([float(values.get(name, 0.0)) for name in FRAME.names or ()])
        x_m += speed_mps * STEP_S
    for collision in collisions:
        recorder.collision(collision)
    for invasion in lane_invasions:
        recorder.lane_invasion(invasion)
    return recorder.history(
        Facts(
            step_s=STEP_S,
            vehicle=VEHICLE,
            route=route or straight_route(),
            actor_types={9: "vehicle.audi.tt"},
            actor_sizes={9: (2.0, 0.9)},
        )
    )


def hit(tick: int, other_type: str = "static.poles", other_id: int = 0, impulse: float = 100.0) -> Collision:
    """One message of the collision sensor."""
    return Collision(tick=tick, other_id=other_id, other_type=other_type, impulse_ns=(impulse, 0.0, 0.0))


def at(speed_mps: float, seconds: float) -> list[float]:
    """A speed held for a time."""
    return [speed_mps] * round(seconds / STEP_S)


def ramp(from_mps: float, to_mps: float, seconds: float) -> list[float]:
    """A steady change of speed."""
    return np.linspace(from_mps, to_mps, round(seconds / STEP_S)).tolist()
