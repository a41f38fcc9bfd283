"""The agent's sensors: spawned from its sensor set, heard in step with the ticks."""

from __future__ import annotations

import contextlib
import threading
from typing import TYPE_CHECKING, Any

import carla

from basu.agents.sensor_file import SensorSpec, check_sensors
from basu.errors import SimulatorError, UserError
from basu.managers.base_manager import BaseManager

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu.managers.base_manager import Frame, Run

# These speak when something happens, not every tick: nobody waits for them.
ON_EVENT = frozenset(
    {
        "sensor.other.collision",
        "sensor.other.lane_invasion",
        "sensor.other.obstacle",
        "sensor.other.rss",
        "sensor.other.v2x",
        "sensor.other.v2x_custom",
    }
)

PARTING_TICKS = 3
"""Steps between the last measurement and the end of a sensor: what the client has under way arrives meanwhile."""


class SensorsManager(BaseManager):
    """After ``tick``, ``data`` holds each sensor's latest measurement with the frame it was made in, by sensor id."""

    def __init__(
        self,
        specs: tuple[SensorSpec, ...],
        source: str,
        late: Callable[[], tuple[SensorSpec, ...]] = tuple,
    ) -> None:
        """Take a sensor set; ``source`` says in complaints who gave it; ``late`` gives more once all is set up."""
        self._specs, self._source, self._late = specs, source, late
        self._world: Any = None
        self._actors: list[Any] = []
        self._news = threading.Condition()
        self._latest: dict[str, tuple[int, Any]] = {}
        self._period: dict[str, int] = {}  # in ticks, of those that are waited for
        self._timeout_s = 0.0
        self.data: dict[str, tuple[int, Any]] = {}

    @property
    def types(self) -> dict[str, str]:
        """The blueprint id of each sensor, by the id it has in the set."""
        return {spec.id: spec.type_id for spec in self._specs}

    def setup(self, run: Run) -> None:
        """Attach the sensors to the vehicle."""
        self._specs += self._late()
        if not self._specs:
            return
        self._world = run.world
        library = run.world.get_blueprint_library()
        check_sensors(self._specs, library, self._source)
        self._timeout_s = run.timeout_s
        for spec in self._specs:
            blueprint = library.find(spec.type_id)
            if blueprint.has_attribute("noise_seed"):
                blueprint.set_attribute("noise_seed", str(run.seed))
            for name, value in spec.attributes:
                blueprint.set_attribute(name, value)
            self._attach(spec, blueprint, run)

    def tick(self, frame: Frame) -> None:
        """Wait until every sensor that is due has answered for this frame."""
        if not self._period:
            self.data = self._in_order()
            return
        with self._news:
            if not self._news.wait_for(lambda: not self._missing(frame.server_frame), timeout=self._timeout_s):
                silent = ", ".join(self._missing(frame.server_frame))
                raise SimulatorError(f"sensor {silent} did not answer for frame {frame.server_frame} in time")
            self.data = self._in_order()

    def close(self) -> None:
        """Stop listening, let go of what was measured, and take the sensors away."""
        with contextlib.suppress(RuntimeError):  # the simulator is gone, and all sensors with it
            for actor in self._actors:
                actor.stop()
            for _ in range(PARTING_TICKS if self._actors else 0):
                self._world.tick(self._timeout_s)
        self._latest, self.data = {}, {}
        while self._actors:
            with contextlib.suppress(RuntimeError):  # the actor is gone, which is what was wanted
                self._actors.pop().destroy()

    def _attach(self, spec: SensorSpec, blueprint: carla.ActorBlueprint, run: Run) -> None:
        """Spawn one sensor and listen to it."""
        pose = carla.Transform(
            carla.Location(spec.x_m, spec.y_m, spec.z_m),
            carla.Rotation(roll=spec.roll_deg, pitch=spec.pitch_deg, yaw=spec.yaw_deg),
        )
        try:
            actor = run.world.spawn_actor(blueprint, pose, attach_to=run.vehicle)
            self._actors.append(actor)
            actor.listen(self._hearer(spec.id))
        except RuntimeError as error:
            raise UserError(
                f"{self._source}: sensor '{spec.id}' ({spec.type_id}) cannot be served by this simulator: {error}"
            ) from error
        if spec.type_id not in ON_EVENT:
            tick_s = float(dict(spec.attributes).get("sensor_tick", "0"))
            self._period[spec.id] = max(1, round(tick_s / run.step_s))

    def _hearer(self, sensor_id: str) -> Callable[[carla.SensorData], None]:
        """What the client calls, on threads of its own, with each measurement."""

        def hear(measurement: carla.SensorData) -> None:
            with self._news:
                self._latest[sensor_id] = (measurement.frame, measurement)
                self._news.notify()

        return hear

    def _in_order(self) -> dict[str, tuple[int, Any]]:
        """The latest measurements in the order of the set, whoever answered first."""
        return {spec.id: self._latest[spec.id] for spec in self._specs if spec.id in self._latest}

    def _missing(self, server_frame: int) -> list[str]:
        """The sensors that are due in this frame and have not answered."""
        return [
            sensor_id
            for sensor_id, period in self._period.items()
            if sensor_id not in self._latest or server_frame - self._latest[sensor_id][0] >= period
        ]
