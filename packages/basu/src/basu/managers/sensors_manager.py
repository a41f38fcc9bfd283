"""`SensorsManager`: spawns the agent's sensors; each tick waits for data, unless the agent's process receives it."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any

import carla

from basu.agents.sensor_file import SensorSpec, check_sensors
from basu.agents.sensor_streams import ON_EVENT, RADIOS, SensorSilentError, SensorStreams, SpawnedSensor
from basu.errors import AgentCrashedError, BasuError, SimulatorError, UserError
from basu.managers.base_manager import BaseManager

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from basu.agents.sensor_streams import SensorListener
    from basu.managers.base_manager import Frame, Run

PARTING_TICKS = 3
"""Steps between the last measurement and the end of a sensor: what the client has under way arrives meanwhile."""


class SensorsManager(BaseManager):
    """After ``tick``, ``data`` holds each sensor's latest measurement with the frame it was made in, by sensor id.

    It stays empty where the agent's process listens itself and nothing else looks at the measurements.
    """

    def __init__(
        self,
        specs: tuple[SensorSpec, ...],
        source: str,
        late: Callable[[], tuple[SensorSpec, ...]] = tuple,
        *,
        listener: SensorListener | None = None,
        is_watched: bool = False,
        by_agent: bool = False,
    ) -> None:
        """Take a sensor set.

        Args:
            specs: the set as far as it is known.
            source: what complaints begin with: where the set comes from.
            late: gives more sensors once the agent is set up.
            listener: receives the measurements for the agent, maybe in its own process.
            by_agent: whether a set that cannot be served is the agent's failure, and not the set-up's.
            is_watched: whether a page, a bag or a topic shows the measurements, so that they are received here as well.
        """
        self._specs, self._source, self._late = specs, source, late
        self._listener, self._is_watched = listener, is_watched
        self._refusal: type[BasuError] = AgentCrashedError if by_agent else UserError
        self._client: Any = None
        self._world: Any = None
        self._actors: list[Any] = []
        self._streams = SensorStreams(0.0)
        self._timeout_s = 0.0
        self._is_stopped = False
        self.data: dict[str, tuple[int, Any]] = {}

    @property
    def specs(self) -> tuple[SensorSpec, ...]:
        """The set, complete after ``setup``."""
        return self._specs

    @property
    def types(self) -> dict[str, str]:
        """The blueprint id of each sensor, by the id it has in the set."""
        return {spec.id: spec.type_id for spec in self._specs}

    def setup(self, run: Run) -> None:
        """Attach the sensors to the vehicle."""
        self._specs += self._late()
        if not self._specs:
            return
        self._client, self._world = run.client, run.world
        library = run.world.get_blueprint_library()
        try:
            check_sensors(self._specs, library, self._source)
        except UserError as error:
            raise self._refusal(str(error)) from error
        self._timeout_s = run.timeout_s
        self._streams = SensorStreams(run.timeout_s)
        sensors = [self._spawned(spec, _blueprint(library, spec, run), run) for spec in self._specs]
        elsewhere = self._listener is not None and self._listener.open_sensor_streams(sensors)
        if elsewhere and not self._is_watched:
            return
        for spec, sensor, actor in zip(self._specs, sensors, self._actors, strict=True):
            with self._serving(spec):
                self._streams.listen(sensor._replace(as_numpy=False), actor)

    def tick(self, frame: Frame) -> None:
        """Wait until every sensor that is due has answered for this frame."""
        try:
            self.data = self._streams.wait(frame.server_frame)
        except SensorSilentError as error:
            raise SimulatorError(str(error)) from error

    def stop(self) -> None:
        """Stop listening. `close` then makes no step of the world: it comes `PARTING_TICKS` steps later."""
        if self._is_stopped:
            return
        self._is_stopped = True
        try:
            if self._listener is not None and self._actors:
                self._listener.close_sensor_streams()
        finally:
            self._streams.stop()

    def close(self) -> None:
        """Stop listening, let go of what was measured, and take the sensors away, whatever the agent's process says."""
        parting_ticks = 0 if self._is_stopped else PARTING_TICKS
        try:
            self.stop()
        finally:
            self._take_away(parting_ticks)

    def _take_away(self, parting_ticks: int) -> None:
        if not self._actors:
            return
        with contextlib.suppress(RuntimeError):  # the simulator is gone, and all sensors with it
            for _ in range(parting_ticks):
                self._world.tick(self._timeout_s)
            # by command: the client warns of sensors that are destroyed and that it never listened to
            self._client.apply_batch_sync([carla.command.DestroyActor(actor.id) for actor in self._actors])
        self.data, self._actors = {}, []

    def _spawned(self, spec: SensorSpec, blueprint: carla.ActorBlueprint, run: Run) -> SpawnedSensor:
        """Spawn one sensor."""
        pose = carla.Transform(
            carla.Location(spec.x_m, spec.y_m, spec.z_m),
            carla.Rotation(roll=spec.roll_deg, pitch=spec.pitch_deg, yaw=spec.yaw_deg),
        )
        with self._serving(spec):
            actor = run.world.spawn_actor(blueprint, pose, attach_to=run.vehicle)
        self._actors.append(actor)
        is_awaited = spec.type_id not in ON_EVENT or _speaks_every_tick(spec, run)
        period_ticks = max(1, round(_tick_s(spec) / run.step_s)) if is_awaited else 0
        return SpawnedSensor(spec.id, actor.id, period_ticks, spec.as_numpy)

    @contextlib.contextmanager
    def _serving(self, spec: SensorSpec) -> Iterator[None]:
        """Calls for one sensor; a refusal is the set's fault.

        Raises:
            AgentCrashedError, UserError: the simulator refused.
        """
        try:
            yield
        except RuntimeError as error:
            raise self._refusal(
                f"{self._source}: sensor '{spec.id}' ({spec.type_id}) cannot be served by this simulator: {error}"
            ) from error


def _tick_s(spec: SensorSpec) -> float:
    """The time between two measurements that a sensor set asks for; 0 means every tick."""
    return float(dict(spec.attributes).get("sensor_tick", "0"))


def _speaks_every_tick(spec: SensorSpec, run: Run) -> bool:
    """Whether a sensor is a radio of our own simulator: it hands over in every tick, if need be nothing."""
    return run.own_simulator and spec.type_id in RADIOS


def _blueprint(library: carla.BlueprintLibrary, spec: SensorSpec, run: Run) -> carla.ActorBlueprint:
    """The blueprint of a sensor with all its attributes."""
    blueprint = library.find(spec.type_id)
    if blueprint.has_attribute("noise_seed"):
        blueprint.set_attribute("noise_seed", str(run.seed))
    for name, value in spec.attributes:
        blueprint.set_attribute(name, value)
    if _speaks_every_tick(spec, run) and _tick_s(spec) == 0.0:
        blueprint.set_attribute("sensor_tick", str(run.step_s))
    return blueprint
