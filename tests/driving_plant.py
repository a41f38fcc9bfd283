"""A small world without a server to drive the basic agent in: a vehicle, routes drawn by hand, and people on scripts.

The vehicle is a kinematic bicycle whose pedals do not do what the agent's model of them says: less throttle, more
brake, drag and rolling resistance that the model knows nothing of, and one step of delay.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.agents.builtin.driving.controllers import DriveModel
from basu.agents.builtin.driving.driver import BehavioralDriver, Driver, DrivingCommand
from basu.agents.builtin.driving.manner import NORMAL, Manner
from basu.agents.builtin.driving.task import make_task
from basu.agents.builtin.passing.road import make_road
from basu.agents.builtin.rules.stopping_lines import Light
from basu.agents.builtin.scene import ActorKind, DrivenVehicle, Other, VehicleGeometry
from basu.routing import ControlKind, Route, RouteControl, Stop

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

DT_S = 0.05
SHUTTLE_BODY = VehicleGeometry(wheelbase_m=2.8, rear_axle_m=1.4, front_m=2.01, rear_m=2.01, half_width_m=1.0)
SHUTTLE_MODEL = DriveModel(tuple(float(v) for v in range(0, 21, 2)), (1.7,) * 3 + (1.2,) * 2 + (0.8,) * 6, 6.0)
SHUTTLE_TOP_MPS = 6.7


class Log(NamedTuple):
    """A drive, one row a step; all (N,) but ``reasons``."""

    time_s: NDArray[np.float64]
    s_m: NDArray[np.float64]
    lateral_m: NDArray[np.float64]
    speed_mps: NDArray[np.float64]
    x_m: NDArray[np.float64]
    y_m: NDArray[np.float64]
    reasons: list[str]

    @property
    def accel_mps2(self) -> NDArray[np.float64]:
        return np.diff(self.speed_mps) / DT_S

    @property
    def jerk_mps3(self) -> NDArray[np.float64]:
        return np.diff(self.accel_mps2) / DT_S


class Plant:
    """The vehicle that is really driven."""

    def __init__(self, x_m: float, y_m: float, yaw_rad: float, speed_mps: float = 0.0) -> None:
        self.time_s, self.x_m, self.y_m, self.yaw_rad, self.speed_mps = 0.0, x_m, y_m, yaw_rad, speed_mps

    def ego(self) -> DrivenVehicle:
        return DrivenVehicle(self.time_s, self.x_m, self.y_m, self.yaw_rad, self.speed_mps)

    def step(self, command: DrivingCommand) -> None:
        v = self.speed_mps
        pull = 0.85 * command.throttle * SHUTTLE_MODEL.throttle_mps2(v)
        resist = 1.2 * command.brake * 6.0 + (0.08 + 0.002 * v * v if v > 0.0 or pull > 0.08 else pull)
        self.speed_mps = max(0.0, v + (pull - resist) * DT_S)
        slip = math.atan(SHUTTLE_BODY.rear_axle_m / SHUTTLE_BODY.wheelbase_m * math.tan(command.steer_rad))
        self.x_m += self.speed_mps * math.cos(self.yaw_rad + slip) * DT_S
        self.y_m += self.speed_mps * math.sin(self.yaw_rad + slip) * DT_S
        self.yaw_rad += self.speed_mps / SHUTTLE_BODY.rear_axle_m * math.sin(slip) * DT_S
        self.time_s += DT_S


def line(length_m: float) -> NDArray[np.float64]:
    """(N, 3) a straight street to the east."""
    x_m = np.arange(0.0, length_m + 0.5)
    return np.column_stack([x_m, np.zeros_like(x_m), np.zeros_like(x_m)])


def bends(*pieces: tuple[float, float]) -> NDArray[np.float64]:
    """(N, 3) pieces of (length m, curvature 1/m) after one another, starting to the east."""
    x_m, y_m, yaw_rad, step_m = 0.0, 0.0, 0.0, 0.1
    points = [(x_m, y_m, 0.0)]
    for length_m, curvature_1pm in pieces:
        for _ in range(round(length_m / step_m)):
            middle_rad = yaw_rad + 0.5 * curvature_1pm * step_m
            x_m, y_m = x_m + step_m * math.cos(middle_rad), y_m + step_m * math.sin(middle_rad)
            yaw_rad += curvature_1pm * step_m
            points.append((x_m, y_m, 0.0))
    return np.array(points[::10])


def make_route(
    points_m: NDArray[np.float64],
    *,
    limit_mps: float = 11.176,
    controls: Sequence[tuple[ControlKind, float]] = (),
    stops_at_s_m: Sequence[float] = (),
    junctions_s_m: Sequence[tuple[float, float]] = (),
) -> Route:
    """A route as BASU would plan it."""
    steps = np.diff(points_m[:, :2], axis=0)
    s_m = np.concatenate([[0.0], np.cumsum(np.hypot(steps[:, 0], steps[:, 1]))])
    count = len(s_m)
    place = {"x_m": 0.0, "y_m": 0.0, "z_m": 0.0, "yaw_rad": 0.0}
    inside = np.zeros(count, dtype=np.bool_)
    for begin_m, end_m in junctions_s_m:
        inside |= (s_m >= begin_m) & (s_m <= end_m)
    return Route(
        id="test",
        town="nowhere",
        points_m=points_m,
        s_m=s_m,
        yaw_rad=np.arctan2(np.gradient(points_m[:, 1]), np.gradient(points_m[:, 0])),
        lane_width_m=np.full(count, 3.2),
        speed_limit_mps=np.full(count, limit_mps),
        is_junction=inside,
        road_id=np.ones(count, dtype=np.int64),
        lane_id=np.full(count, -1, dtype=np.int64),
        stops=tuple(Stop(id=str(n), name=f"S{n}", s_m=at_m, **place) for n, at_m in enumerate(stops_at_s_m)),
        controls=tuple(
            RouteControl(kind=kind, landmark_id=str(n), s_m=at_m, **place) for n, (kind, at_m) in enumerate(controls)
        ),
    )


def nobody(_time_s: float) -> list[Other]:
    """An empty street."""
    return []


def make_driver(route: Route, cap_mps: float = SHUTTLE_TOP_MPS) -> Driver:
    """The basic agent's driver in the shuttle."""
    return Driver(make_task(route, SHUTTLE_BODY, cap_mps), SHUTTLE_BODY, SHUTTLE_MODEL, DT_S)


def make_behavioral(
    route: Route,
    manner: Manner = NORMAL,
    *,
    cap_mps: float = SHUTTLE_TOP_MPS,
    left_width_m: float = 3.2,
    right_lane_m: float = 0.0,
) -> BehavioralDriver:
    """A behavioral driver in the shuttle, on a street with a lane to its left and, if so wished, one to its right."""
    task = make_task(route, SHUTTLE_BODY, cap_mps, manner)
    count = len(route.s_m)
    road = make_road(route, task.path, np.full(count, left_width_m), np.full(count, right_lane_m), 15.0)
    return BehavioralDriver(task, road, SHUTTLE_BODY, SHUTTLE_MODEL, DT_S, manner)


def drive(
    driver: Driver,
    plant: Plant,
    seconds: float,
    others: Callable[[float], Sequence[Other]] = nobody,
    shows: Callable[[float], Light] = lambda _time_s: Light.GREEN,
) -> Log:
    """Drive for a while; ``others`` and ``shows`` tell who is where and what the light shows at a time."""
    rows, reasons = [], []
    for _ in range(round(seconds / DT_S)):
        ego = plant.ego()
        command = driver.step(ego, others(ego.time_s), lambda _id, now_s=ego.time_s: shows(now_s))
        assert driver.place is not None
        rows.append((ego.time_s, driver.place.s_m, driver.place.lateral_m, ego.speed_mps, ego.x_m, ego.y_m))
        reasons.append(driver.planner.reason)
        plant.step(command)
    return Log(*np.array(rows).T, reasons)


def body_at(
    kind: ActorKind,
    x_m: float,
    y_m: float,
    *,
    velocity_mps: tuple[float, float] = (0.0, 0.0),
    yaw_deg: float = 0.0,
    number: int = 7,
) -> Other:
    """Somebody of the usual size."""
    half_length_m, half_width_m = {
        ActorKind.VEHICLE: (2.2, 0.95),
        ActorKind.WALKER: (0.2, 0.2),
        ActorKind.PROP: (0.4, 0.4),
    }[kind]
    return Other(number, kind, x_m, y_m, math.radians(yaw_deg), *velocity_mps, 0.0, half_length_m, half_width_m)
