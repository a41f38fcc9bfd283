"""``basu run egodriver:HOST:PORT``: a policy behind AlpaSim's ``egodriver`` protocol drives.

Simulated time stands still until the policy has answered. The agent requests a trajectory every 0.1 s, which is
AlpaSim's default. Between two answers a controller follows the trajectory.
"""

from __future__ import annotations

import uuid
from typing import TYPE_CHECKING, Any

import carla
from carla_driver_interface.protocol import DriveRequest

from basu.agents.autonomous_agent import AddressedAgent
from basu.agents.builtin.driving.controllers import HOLD_BRAKE
from basu.agents.builtin.perception import read_facts, see_ego
from basu.agents.calls import SETUP_LIMIT_S
from basu.agents.sensor_file import read_sensors
from basu.conditions import SENSORS
from basu.errors import AgentCrashedError, UserError
from basu.files import find
from basu.records.motion import motion_of
from basu.routing import ControlKind
from basu.routing.planned_route import Progress, advance
from basu_alpasim import observations
from basu_alpasim.frames import OriginPose, rig_pose
from basu_alpasim.plan import Trajectory, read_plan
from basu_alpasim.policy_client import Call, PolicyClient
from basu_alpasim.tracking import TrajectoryControl

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.agents.builtin.perception import VehicleFacts
    from basu.agents.builtin.scene import DrivenVehicle
    from basu.agents.sensor_file import SensorSpec
    from basu.records.motion import VehicleMotion
    from basu.routing import Route

APPEARS_S = SETUP_LIMIT_S - 20.0  # wall time for a policy to appear: it may load a network
ASK_EVERY_S = 0.1  # simulated time between two requests: AlpaSim's control_timestep_us
ADDRESS = "127.0.0.1:50051"  # the port of carla-driver-interface and of AlpaSim's own driver


class EgodriverAgent(AddressedAgent):
    """A policy of AlpaSim at an address."""

    address = ADDRESS
    appears_s = APPEARS_S
    _client: PolicyClient | None = None
    _control: TrajectoryControl | None = None
    _trajectory: Trajectory | None = None

    def setup(self) -> None:
        """Wait until the policy answers, and look up the lights on the way."""
        if self.route is None:
            raise UserError("egodriver follows a route and was given none; name one with --routes")
        file = self.config_values.get("sensors")
        specs = () if file is None else read_sensors(find(str(file), "sensor file"))
        self._specs = {spec.id: spec for spec in specs}
        self._tells = self.config_values.get("track") != SENSORS
        self._lights = [
            (control, light)
            for control in self.route.controls
            if self._tells
            and control.kind is ControlKind.TRAFFIC_LIGHT
            and (light := self.world.get_traffic_light_from_opendrive_id(control.landmark_id)) is not None
        ]
        self._every = max(1, round(ASK_EVERY_S / self.time_step_s))
        self._session = str(uuid.uuid4())
        self._progress = Progress.at_start()  # of the rear axle
        self._motions: list[tuple[int, VehicleMotion]] = []  # since the last request
        self._sent: dict[str, int] = {}  # the frame of the last picture, by camera
        self._first_frame: int | None = None
        self._client = PolicyClient(self.address)
        self._client.await_ready(self.appears_s)

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        """Request a trajectory where one is due, and follow the last one."""
        snapshot = self.world.get_snapshot()
        own = snapshot.find(self.vehicle.id)
        if own is None:
            return carla.VehicleControl(brake=HOLD_BRAKE)  # not in the world before its first tick
        if self._control is None or self._first_frame is None:
            self._begin(snapshot.frame, own.get_transform())
        assert self._control is not None
        assert self._first_frame is not None
        ticks = snapshot.frame - self._first_frame
        now_us = self._time_us(snapshot.frame)
        ego = see_ego(snapshot, own, self.vehicle.get_control())._replace(time_s=now_us * 1e-6)
        self._motions.append((now_us, motion_of(own)))
        assert self.route is not None  # setup refuses
        axle = rig_pose(self._motions[-1][1], self._facts.body.rear_axle_m).position
        self._progress = advance(self.route, self._progress, float(axle[0]), -float(axle[1]))
        if self._trajectory is None or ticks % self._every == 0:
            self._trajectory = self._ask(snapshot.frame, now_us, ego, sensor_data)
        return self._control.step(self._trajectory, ego)

    def config(self) -> dict[str, str]:
        """The car on the short route, with AlpaSim's front camera."""
        return {
            "routes": "routes/linden_short.xml",
            "sensors": "config/egodriver_sensors.json",
            "vehicle": "vehicle.tesla.model3",
            "weather": "ClearNoon",
        }

    def destroy(self) -> None:
        """Close the session and the connection."""
        if self._client is not None:
            self._client.close()

    def _begin(self, frame: int, pose: carla.Transform) -> None:
        """Read the vehicle where it stands, and start the session with its cameras."""
        assert self._client is not None
        self._first_frame = frame
        self._facts: VehicleFacts = read_facts(self.vehicle, pose)
        self._control = TrajectoryControl(self._facts, self.time_step_s)
        cameras = [spec for spec in self._specs.values() if spec.type_id == observations.CAMERA]
        axle_m, revision = self._facts.body.rear_axle_m, self._client.revision
        self._client.start(observations.session_request(self._session, cameras, axle_m, revision), 0)

    def _time_us(self, frame: int) -> int:
        """The time of a frame since the first one."""
        assert self._first_frame is not None
        return round((frame - self._first_frame) * self.time_step_s * 1e6)

    def _ask(
        self, frame: int, now_us: int, ego: DrivenVehicle, sensor_data: Mapping[str, tuple[int, Any]]
    ) -> Trajectory:
        """Send the observations, and return the policy's answer to them.

        Raises:
            AgentError: there is none, or it is no trajectory.
        """
        assert self._client is not None
        axle_m, route = self._facts.body.rear_axle_m, self._route
        fresh = self._fresh(sensor_data)
        rig = rig_pose(self._motions[-1][1], axle_m)
        told = [
            Call("submit_egomotion_observation", observations.egomotion(self._session, self._motions, axle_m)),
            Call("submit_route", observations.route_ahead(self._session, now_us, route, self._progress.s_m, rig)),
            *(
                Call(
                    "submit_image_observation",
                    observations.image_observation(self._session, spec.id, self._time_us(made_in), data),
                )
                for spec, made_in, data in fresh
                if spec.type_id == observations.CAMERA
            ),
        ]
        self._client.call(told, now_us)
        self._motions.clear()
        request = DriveRequest(
            session_uuid=self._session,
            time_now_us=now_us,
            time_query_us=now_us + round(self._every * self.time_step_s * 1e6),
            renderer_data=self._carlas_data(frame, now_us, fresh) if self._tells else b"",
        )
        response = self._client.call([Call("drive", request)], now_us)[0]
        if response.terminate_session:
            raise AgentCrashedError(
                f"the policy at {self.address} ended the session with its answer to drive at {now_us * 1e-6:.2f} s"
            )
        here = OriginPose(ego.x_m, ego.y_m, ego.yaw_rad)
        return Trajectory(read_plan(response, now_us, axle_m), now_us, here)

    @property
    def _route(self) -> Route:
        """The route, which setup has checked."""
        assert self.route is not None
        return self.route

    def _fresh(self, sensor_data: Mapping[str, tuple[int, Any]]) -> list[tuple[SensorSpec, int, Any]]:
        """Measurements that are new since the last request, each with the frame in which it was made."""
        fresh = []
        for sensor_id, spec in self._specs.items():
            made_in, data = sensor_data.get(sensor_id, (None, None))
            if made_in is not None and self._sent.get(sensor_id) != made_in:
                self._sent[sensor_id] = made_in
                fresh.append((spec, made_in, data))
        return fresh

    def _carlas_data(self, frame: int, now_us: int, fresh: list[tuple[SensorSpec, int, Any]]) -> bytes:
        """What an agent of BASU knows beside its sensors, and the points of its lidars."""
        axle_m, place_m = self._facts.body.rear_axle_m, self._progress.s_m
        nearest = int(self._route.s_m.searchsorted(place_m).clip(0, len(self._route.s_m) - 1))
        return observations.renderer_data(
            time_us=now_us,
            frame=frame,
            town=self._route.town,
            limit_mps=float(self._route.speed_limit_mps[nearest]),
            lights=[(control, str(light.get_state())) for control, light in self._lights],
            s_m=place_m,
            others=self.visible_actors(),
            sweeps=[
                observations.sweep(spec, self._time_us(made_in), data, axle_m)
                for spec, made_in, data in fresh
                if spec.type_id == observations.LIDAR
            ],
        )
