"""The vehicle under test as the source of ROS messages: its sensors once, its moment in each frame of a run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.agents.sensor_streams import ON_EVENT
from basu_ros.agents.vehicle_source import BRAKED, control_of, mount_of
from basu_ros.moment import Actor, Light, Measurement, Moment, Motion, Vehicle

if TYPE_CHECKING:
    from basu.managers.base_manager import Frame, Run
    from basu.managers.sensors_manager import SensorsManager


class LiveVehicle:
    """Makes moments of a run's frames; the events of the agent's sensors are left out, for the record has them."""

    def __init__(self, run: Run, sensors: SensorsManager, *, rear_axle_m: float = 0.0) -> None:
        """Look up sensors and traffic lights of ``run``."""
        self._run, self._sensors = run, sensors
        self._mounts = {spec.id: mount_of(spec) for spec in sensors.specs if spec.type_id not in ON_EVENT}
        self._lights = sorted(run.world.get_actors().filter("traffic.traffic_light"), key=lambda light: light.id)
        self._last_lights: tuple[Light, ...] = ()
        self._sent: dict[str, int] = {}  # the frame of the latest measurement, by sensor
        role = run.vehicle.attributes["role_name"]
        self.vehicle = Vehicle(role, tuple(self._mounts.values()), run.step_s, rear_axle_m)

    def moment(self, frame: Frame) -> Moment:
        """Return the frame. Lights are in it when one has changed, a measurement when it is new."""
        run = self._run
        lights = tuple(Light(light.id, int(light.get_state())) for light in self._lights)
        changed, self._last_lights = lights != self._last_lights, lights
        applied = run.changes.control
        return Moment(
            t_s=frame.tick * run.step_s,
            frame=frame.tick,
            motion=Motion(*frame.ego),
            control=BRAKED if applied is None else control_of(applied),
            others=self._others(frame),
            lights=lights if changed else (),
            measured=self._measured(),
        )

    def _others(self, frame: Frame) -> list[Actor]:
        """The actors that the record has in this frame."""
        near = self._run.neighbours
        if near is None:
            return []
        return [
            Actor._make((int(row[1]), near.met[int(row[1])], *row[2:], *near.sizes[int(row[1])]))
            for row in near.near(frame)
        ]

    def _measured(self) -> list[Measurement]:
        """Measurements that are new since the last frame, in the order of the sensors."""
        fresh = []
        for sensor_id, mount in self._mounts.items():
            made_in, data = self._sensors.data.get(sensor_id, (None, None))
            if made_in is not None and self._sent.get(sensor_id) != made_in:
                self._sent[sensor_id] = made_in
                fresh.append(Measurement(mount, data))
        return fresh
