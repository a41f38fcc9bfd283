"""BASU's agents ``basic``, ``behavioral`` and their like as policies of ``carla_driver_interface``.

With a route of its own it knows signs, lights, stops and limits on the way, as the agent knows them. Otherwise it knows
the points of the route that the simulator sends, and follows them at a given speed. It sees other actors, the states of
lights and the posted limit where the simulator sends CARLA's data. It looks at no pictures.
"""

from __future__ import annotations

import math
import zlib
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from carla_driver_interface.driver import BaseDriver, DriveResult
from carla_driver_interface.geometry import Pose, Trajectory
from carla_driver_interface.protocol import TrafficLightState

from basu.agents.builtin.baselines import CREEP_MPS
from basu.agents.builtin.behavioral import UNPOSTED_MPS, beside
from basu.agents.builtin.driving.driver import BehavioralDriver, Driver
from basu.agents.builtin.driving.manner import AGGRESSIVE, BASIC, CAUTIOUS, NORMAL
from basu.agents.builtin.driving.task import make_task
from basu.agents.builtin.passing.road import make_road
from basu.agents.builtin.rules.stopping_lines import Light
from basu.agents.builtin.scene import ActorKind, DrivenVehicle, Other
from basu.routing import Route
from basu_alpasim.frames import origin_of, pose_of
from basu_alpasim.rollout import UNUSED_PEDALS, PlanningDriver

if TYPE_CHECKING:
    from carla_driver_interface.driver import DriveContext, SessionState
    from carla_driver_interface.protocol import CarlaActorState, CarlaRendererData
    from numpy.typing import NDArray

    from basu.agents.builtin.driving.manner import Manner
    from basu.agents.builtin.scene import VehicleGeometry
    from basu_alpasim.rollout import Rolled

WIDE_M = 100.0  # a lane of unknown width: the path keeps to its middle
USUAL_STEP_S = 0.1  # between two requests, where one does not say when the next one comes
LEAST_POINTS = 2  # of a route
LEAST_M = 1.0  # of a route: less has no direction
SAME_M = 0.05  # points of a route that lie nearer together than this are one
UNKNOWN = TrafficLightState.TRAFFIC_LIGHT_STATE_UNKNOWN
SHOWN = {
    TrafficLightState.TRAFFIC_LIGHT_STATE_RED: Light.RED,
    TrafficLightState.TRAFFIC_LIGHT_STATE_YELLOW: Light.YELLOW,
    TrafficLightState.TRAFFIC_LIGHT_STATE_GREEN: Light.GREEN,
}
KIND_OF_TYPE = {"vehicle": ActorKind.VEHICLE, "walker": ActorKind.WALKER}


class Offered(NamedTuple):
    """An agent of BASU's as a policy."""

    manner: Manner = BASIC  # one with a way of passing drives as the agent ``behavioral`` does
    sees_others: bool = True
    cap_mps: float = math.inf


OFFERED = {
    "basic": Offered(),
    "behavioral": Offered(NORMAL),
    "behavioral-cautious": Offered(CAUTIOUS),
    "behavioral-aggressive": Offered(AGGRESSIVE),
    "blind": Offered(sees_others=False),
    "creeper": Offered(sees_others=False, cap_mps=CREEP_MPS),
}
"""The agents that drive by a path and a speed. Others press pedals, which the protocol has not, or need a person."""


class Known(NamedTuple):
    """What the policy knows before any session."""

    body: VehicleGeometry
    route: Route | None  # with its signs; None: as it is sent
    cruise_mps: float  # never faster than this
    agent: str = "basic"  # a key of ``OFFERED``


class BasicPolicy(BaseDriver):
    """An agent for any number of sessions."""

    name = "basu"

    def __init__(self, known: Known) -> None:
        """Take what all sessions have in common."""
        self._known, self._offered = known, OFFERED[known.agent]
        self.name = f"basu-{known.agent}"
        self._drivers: dict[str, PlanningDriver] = {}

    def on_session_close(self, session: SessionState) -> None:
        """Forget the driver of a session."""
        self._drivers.pop(session.uuid, None)

    def drive(self, ctx: DriveContext) -> DriveResult:
        """Return the trajectory of the next seconds; it stands where there is no route."""
        with ctx.session.lock:
            rig, waypoints = ctx.session.latest_pose(), ctx.session.route_waypoints_in_rig
            state = ctx.session.latest_dynamic_state()
        axle_m = self._known.body.rear_axle_m
        if rig is None or state is None:
            return DriveResult(trajectory_in_rig=Trajectory.empty())
        driver = self._driver(ctx, rig, waypoints)
        if driver is None:
            return DriveResult(trajectory_in_rig=_standing(ctx.time_now_us))
        origin = origin_of(rig, axle_m)
        ego = DrivenVehicle(
            ctx.time_now_us * 1e-6, origin.x_m, origin.y_m, origin.yaw_rad, float(state.linear_velocity.x)
        )
        data = ctx.renderer_data
        shown = {} if data is None else {light.opendrive_id: light.state for light in data.traffic_lights}
        others = _others(data) if self._offered.sees_others else []
        rolled = driver.plan(ego, others, lambda light: SHOWN.get(shown.get(light, UNKNOWN), Light.DARK))
        return DriveResult(trajectory_in_rig=_in_rig(rolled, rig, ctx.time_now_us, axle_m))

    def _driver(self, ctx: DriveContext, rig: Pose, waypoints: NDArray[np.float64]) -> PlanningDriver | None:
        """The driver of a session: one for a known route, else a new one for the points that have just come."""
        kept = self._drivers.get(ctx.session.uuid)
        body, route, cruise_mps = self._known.body, self._known.route, self._known.cruise_mps
        if kept is not None and route is not None:
            return kept
        if route is None:
            route = sent_route(rig, waypoints)
            data = ctx.renderer_data
            if data is not None and data.speed_limit_mps > 0.0:
                cruise_mps = min(cruise_mps, data.speed_limit_mps)
        if route is None:
            return None
        step_s = (ctx.time_query_us - ctx.time_now_us) * 1e-6
        step_s = step_s if step_s > 0.0 else USUAL_STEP_S
        driver = PlanningDriver(self._made(route, min(cruise_mps, self._offered.cap_mps), step_s), body, step_s)
        if kept is not None:
            driver.take_over(kept)
        self._drivers[ctx.session.uuid] = driver
        return driver

    def _made(self, route: Route, cruise_mps: float, step_s: float) -> Driver:
        """Return the agent's own driver for a route; it passes others where the route was laid on a map."""
        body, manner = self._known.body, self._offered.manner
        task = make_task(route, body, cruise_mps, manner)
        if manner.passing is None:
            return Driver(task, body, UNUSED_PEDALS, step_s, manner)
        road = make_road(route, task.path, *beside(route), UNPOSTED_MPS)
        return BehavioralDriver(task, road, body, UNUSED_PEDALS, step_s, manner)


def sent_route(rig: Pose, waypoints: NDArray[np.float64]) -> Route | None:
    """Return the points of a route as BASU's route; None where too few are left.

    AlpaSim fills a route that ends with NaN, which are left out. Limits, signs and lanes are not known.
    """
    finite = waypoints[np.isfinite(waypoints).all(axis=1)]
    if len(finite) < LEAST_POINTS:
        return None
    points_m = rig.transform_points(finite) * (1.0, -1.0, 1.0)
    steps_m = np.hypot(*np.diff(points_m[:, :2], axis=0).T)
    points_m = points_m[np.concatenate([[True], steps_m > SAME_M])]
    steps = np.diff(points_m[:, :2], axis=0)
    if np.hypot(*steps.T).sum() < LEAST_M:
        return None
    heading_rad = np.arctan2(steps[:, 1], steps[:, 0])
    count = len(points_m)
    return Route(
        id="sent",
        town="",
        points_m=points_m,
        s_m=np.concatenate([[0.0], np.cumsum(np.hypot(*steps.T))]),
        yaw_rad=np.append(heading_rad, heading_rad[-1]),
        lane_width_m=np.full(count, WIDE_M),
        speed_limit_mps=np.full(count, math.nan),
        is_junction=np.zeros(count, dtype=np.bool_),
        road_id=np.zeros(count, dtype=np.int64),
        lane_id=np.zeros(count, dtype=np.int64),
    )


def _others(data: CarlaRendererData | None) -> list[Other]:
    """The actors of CARLA's data."""
    return [] if data is None else [other_of(actor) for actor in data.actors]


def other_of(actor: CarlaActorState) -> Other:
    """An actor as BASU's agents know it."""
    pose = Pose.from_proto(actor.pose_local_to_aabb)
    velocity = actor.dynamic_state.linear_velocity
    x_m, y_m, z_m = pose.position.tolist()
    across = pose.rotation.apply([velocity.x, velocity.y, velocity.z])
    return Other(
        id=int(actor.track_id) if actor.track_id.isdigit() else zlib.crc32(actor.track_id.encode()),
        kind=KIND_OF_TYPE.get(actor.type_id.partition(".")[0], ActorKind.PROP),
        x_m=x_m,
        y_m=-y_m,
        yaw_rad=-pose.yaw,
        velocity_x_mps=float(across[0]),
        velocity_y_mps=-float(across[1]),
        yaw_rate_radps=-float(actor.dynamic_state.angular_velocity.z),
        half_length_m=actor.aabb.size_x / 2.0,
        half_width_m=actor.aabb.size_y / 2.0,
        z_m=z_m,
        half_height_m=actor.aabb.size_z / 2.0,
    )


def _in_rig(rolled: list[Rolled], rig: Pose, now_us: int, axle_m: float) -> Trajectory:
    """Poses of the vehicle's origin as poses of its rig, in the rig of now."""
    trajectory, into_rig = Trajectory.empty(), rig.inverse()
    height_m = float(rig.position[2])
    for each in rolled:
        origin = pose_of(each.x_m, each.y_m, height_m, yaw_rad=each.yaw_rad)
        pose = into_rig @ origin @ Pose.from_xyz_yaw(-axle_m, 0.0, 0.0, 0.0)
        trajectory.append(now_us + round(each.after_s * 1e6), pose)
    return trajectory


def _standing(now_us: int) -> Trajectory:
    """The present pose for the next second."""
    return Trajectory([now_us + 500_000, now_us + 1_000_000], [Pose.identity(), Pose.identity()])
