"""The HUD's own camera: behind and above the vehicle, and only while somebody looks through it."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

import carla

from basu.errors import SimulatorError
from basu.managers.sensors_manager import PARTING_TICKS

if TYPE_CHECKING:
    from basu.managers.base_manager import Run

BEHIND_M, ABOVE_M, DOWN_DEG = 4.5, 1.6, 12.0  # of the vehicle's rear and roof: it fills the lower middle of the picture


class ChaseCamera:
    """After ``look``, ``latest`` is the newest picture."""

    def __init__(self, run: Run, size: tuple[int, int], every_s: float) -> None:
        """Attach it and begin to take pictures.

        Args:
            run: with the vehicle.
            size: of the picture, in pixels.
            every_s: simulated time from picture to picture; 0 for one a tick.

        Raises:
            SimulatorError: this simulator has no cameras.
        """
        self._world, self._timeout_s = run.world, run.timeout_s
        box = run.vehicle.bounding_box
        pose = carla.Transform(
            carla.Location(x=box.location.x - box.extent.x - BEHIND_M, z=box.location.z + box.extent.z + ABOVE_M),
            carla.Rotation(pitch=-DOWN_DEG),
        )
        self._looks = False
        self.latest: tuple[bytes, tuple[int, int]] | None = None  # BGRA, and its width and height
        actor = None
        try:
            blueprint = run.world.get_blueprint_library().find("sensor.camera.rgb")
            for name, value in (("image_size_x", size[0]), ("image_size_y", size[1]), ("sensor_tick", every_s)):
                blueprint.set_attribute(name, str(value))
            self._actor = actor = run.world.spawn_actor(blueprint, pose, attach_to=run.vehicle)
            self.look(begin=True)
        except (RuntimeError, IndexError) as error:
            if actor is not None:
                actor.destroy()
            raise SimulatorError(f"no camera: {error}") from error

    def look(self, *, begin: bool) -> None:
        """Begin or stop to take pictures."""
        if begin and not self._looks:
            self._actor.listen(self._take)
        elif not begin and self._looks:
            self._actor.stop()
        self._looks = begin

    def close(self) -> None:
        """Take the camera away, once what is under way has arrived."""
        with contextlib.suppress(RuntimeError):  # the simulator is gone, and the camera with it
            if self._looks:
                self._actor.stop()
                for _ in range(PARTING_TICKS):
                    self._world.tick(self._timeout_s)
            self._actor.destroy()

    def _take(self, image: carla.Image) -> None:
        """Keep the bytes and let go of the image; called on a thread of the client."""
        self.latest = bytes(image.raw_data), (image.width, image.height)
