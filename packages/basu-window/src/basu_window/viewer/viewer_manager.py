"""``--viewer``: streams a run to Rerun; the run is not affected."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.managers.base_manager import BaseManager, ego_in
from basu.managers.observations import Neighbours, vehicle_of
from basu_window.viewer import entities
from basu_window.viewer.entities import EVERY_S, log_map, log_route, log_vehicle, show
from basu_window.viewer.layout import Parts, Pose
from basu_window.viewer.stream import Stream, close_stream, has_screen, open_stream

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu.managers import Live
    from basu.managers.base_manager import Frame, Run


RRD_FILE = "run.rrd"  # in the run's folder
SCORE_EVERY_S = 1.0  # of simulated time
MPS_PER_KMH = 1.0 / 3.6


class ViewerManager(BaseManager):
    """Shows each tick as it was recorded."""

    def __init__(self, live: Live, say: Callable[[str], None]) -> None:
        """Observe ``live``; ``say`` prints the viewer's address."""
        self._live, self._say = live, say
        self._stream: Stream | None = None

    def setup(self, run: Run) -> None:
        """Open the recording and show what does not move.

        Raises:
            UserError: its file cannot be written.
        """
        self._run = run
        start = Pose(*ego_in(run.world.get_snapshot().find(run.vehicle.id))[:6])
        cameras = any(".camera." in type_id for type_id in self._live.sensors.types.values())
        name = run.folder.name.strip(".").removesuffix(".part")
        parts = Parts(start, cameras=cameras, judged=True)
        self._stream = open_stream(run.folder / RRD_FILE, name, parts, screen=has_screen())
        recording = self._stream.recording
        self._shower = entities.TickLogger(recording)
        self._neighbours = Neighbours(run.world, run.vehicle.id)
        self._shown_at_s: dict[str, float] = {}
        log_map(recording, run.carla_map)
        log_route(recording, run.route)
        log_vehicle(recording, vehicle_of(run.vehicle))

    def tick(self, frame: Frame) -> None:
        """Show a tick."""
        t_s, ego, control = frame.tick * self._run.step_s, frame.ego, self._live.agents.control
        driving = entities.Driving(
            (ego.velocity_x_mps, ego.velocity_y_mps, ego.velocity_z_mps),
            (ego.acceleration_x_mps2, ego.acceleration_y_mps2, ego.acceleration_z_mps2),
            self._run.vehicle.get_speed_limit() * MPS_PER_KMH,
            control.throttle,
            control.steer,
            control.brake,
        )
        self._shower.tick(t_s, Pose(*ego[:6]), driving, self._others(frame))
        self._senses(t_s)
        if frame.tick % round(SCORE_EVERY_S / self._run.step_s) == 0:
            self._judgement()

    def close(self) -> None:
        """Show the last judgement and end the recording."""
        if self._stream is None:
            return
        stream, self._stream = self._stream, None
        if self._live.metrics.ticks:
            self._judgement()
        close_stream(stream)
        self._say(f"viewer            {RRD_FILE} in the result folder ({stream.said}); `rerun {RRD_FILE}` opens it")

    def _others(self, frame: Frame) -> list[entities.Other]:
        """Return the actors nearby, from the record."""
        return [
            entities.Other(
                int(actor_id),
                self._neighbours.met[int(actor_id)],
                x_m,
                y_m,
                z_m,
                yaw_rad,
                self._neighbours.sizes[int(actor_id)],
            )
            for _, actor_id, x_m, y_m, z_m, yaw_rad, *_velocity in self._neighbours.near(frame)
        ]

    def _senses(self, t_s: float) -> None:
        """Show what the agent's sensors measured, not more often than ``EVERY_S``."""
        types = self._live.sensors.types
        for sensor_id, (_, measured) in self._live.sensors.data.items():
            if t_s >= self._shown_at_s.get(sensor_id, -1.0) + EVERY_S - self._run.step_s / 2.0:
                self._shown_at_s[sensor_id] = t_s
                show(self._shower.recording, sensor_id, types[sensor_id], measured)

    def _judgement(self) -> None:
        """Show the scores so far, and what is held against the driver."""
        self._shower.scores(self._live.metrics.scores_so_far())
        self._shower.infractions(self._live.metrics.infractions_so_far())
