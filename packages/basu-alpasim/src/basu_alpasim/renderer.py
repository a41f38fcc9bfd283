"""`SceneRenderer`: pictures of a scene from any pose, taken by cameras of a simulator with actors put into place."""

from __future__ import annotations

import contextlib
import math
from typing import TYPE_CHECKING, NamedTuple

import carla
import numpy as np
from carla_driver_interface.geometry import optical_to_body

from basu.agents.sensor_streams import SensorSilentError, SensorStreams, SpawnedSensor
from basu.episode.world import asking
from basu.errors import SimulatorError
from basu_alpasim.frames import transform_of
from basu_alpasim.observations import CAMERA

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from carla_driver_interface.geometry import Pose
    from numpy.typing import NDArray

    from basu.simulator import Simulator
    from basu_alpasim.faces import Faces
    from basu_alpasim.run_scene import RunScene

STEP_S = 0.05
AWAY_Z_M, APART_M = -3000.0, 10.0
"""Where actors wait until they are shown, beyond the sight of each camera, and how far apart."""


class UnknownTrackError(Exception):
    """A request names an actor that cannot be shown; the text says which and why."""


class View(NamedTuple):
    """One picture to take."""

    pose: Pose  # of the camera's optical frame in the local frame
    width: int
    height: int
    lens: float | Faces  # the horizontal field of view in degrees of an ideal camera, or the faces of another lens


class _Shot(NamedTuple):
    """One picture of one of the simulator's own cameras."""

    width: int
    height: int
    fov_deg: float
    transform: carla.Transform

    @property
    def kind(self) -> tuple[int, int, float]:
        """What a camera cannot change once it is there."""
        return self.width, self.height, self.fov_deg


class SceneRenderer:
    """Shows scenes on one simulator, which belongs to it alone and is in synchronous mode."""

    def __init__(self, simulator: Simulator) -> None:
        """Show nothing yet."""
        self._simulator = simulator
        self._scene: RunScene | None = None
        self._world: carla.World = simulator.client.get_world()
        self._before = self._world.get_settings()
        self._actors: dict[str, carla.Actor] = {}
        self._cameras: list[tuple[tuple[int, int, float], carla.Sensor]] = []
        self._streams = SensorStreams(simulator.timeout_s)

    @property
    def shown(self) -> str | None:
        """The id of the scene that is loaded; None before the first picture."""
        return None if self._scene is None else self._scene.id

    def close(self) -> None:
        """Take actors and cameras away, and let the simulator have the settings that it had before."""
        with contextlib.suppress(RuntimeError):  # where the simulator is gone, so are they
            self._clear()
            self._world.apply_settings(self._before)

    def pictures(self, scene: RunScene, views: Sequence[View], objects: Mapping[str, Pose]) -> list[NDArray[np.uint8]]:
        """Return the (H, W, 3) pictures, red first, of one moment of a scene.

        Args:
            scene: has the map and the actors that are shown.
            views: cameras and lenses; all are taken in one step of the simulation.
            objects: the middles of the actors' boxes by track; all other actors of the scene are away.

        Raises:
            UnknownTrackError: an object is no actor of the scene.
            SimulatorError: the simulator went away.
        """
        with asking("a picture for AlpaSim"):
            self._load(scene)
            self._place(scene, objects)
            shots = [shot for view in views for shot in _shots(view)]
            seen = iter(self._taken(shots))
            return [_picture(view, {name: next(seen) for name in _faces(view)}) for view in views]

    def _load(self, scene: RunScene) -> None:
        """Load the map of a scene if another one is there, and put the actors of the last scene away."""
        if self._scene is scene:
            return
        self._clear()
        if self._world.get_map().name.rsplit("/", maxsplit=1)[-1] != scene.town:
            with self._simulator.long_call():
                self._world = self._simulator.client.load_world(scene.town)
        settings = self._world.get_settings()
        settings.synchronous_mode, settings.fixed_delta_seconds = True, STEP_S
        self._world.apply_settings(settings)
        self._scene = scene

    def _clear(self) -> None:
        """Destroy the actors and the cameras."""
        self._streams.stop()
        cameras = [camera for _, camera in self._cameras]
        gone = [carla.command.DestroyActor(each.id) for each in (*self._actors.values(), *cameras)]
        self._simulator.client.apply_batch_sync(gone)
        self._actors, self._cameras = {}, []

    def _place(self, scene: RunScene, objects: Mapping[str, Pose]) -> None:
        """Put the middles of actors' boxes to their poses, and the other actors away."""
        commands = []
        for number, (track, actor) in enumerate(self._actors.items()):
            if track not in objects:
                commands.append(carla.command.ApplyTransform(actor.id, _away(number)))
        for track, pose in objects.items():
            if track not in self._actors:
                self._actors[track] = self._spawned(scene, track)
            actor, transform = self._actors[track], transform_of(pose)
            middle = actor.bounding_box.location
            turned = carla.Transform(carla.Location(), transform.rotation).transform(middle)
            transform.location -= turned
            commands.append(carla.command.ApplyTransform(actor.id, transform))
        self._simulator.client.apply_batch_sync(commands)

    def _spawned(self, scene: RunScene, track: str) -> carla.Actor:
        """Spawn the actor of a track, without physics.

        Raises:
            UnknownTrackError: the scene has none, or the simulator cannot show it.
        """
        if track not in scene.actors:
            known = ", ".join(sorted(scene.actors)) or "none"
            raise UnknownTrackError(f"scene '{scene.id}' has no track '{track}'; its tracks: {known}")
        try:
            blueprint = self._world.get_blueprint_library().find(scene.actors[track])
            actor = self._world.spawn_actor(blueprint, _away(len(self._actors)))
        except (IndexError, RuntimeError) as error:
            raise UnknownTrackError(
                f"track '{track}' is a {scene.actors[track]}, which cannot be shown: {error}"
            ) from None
        actor.set_simulate_physics(False)
        return actor

    def _taken(self, shots: Sequence[_Shot]) -> list[NDArray[np.uint8]]:
        """Return the (H, W, 3) pictures of the simulator's cameras, in one step.

        Raises:
            SimulatorError: a camera gave none.
        """
        if [kind for kind, _ in self._cameras] != [shot.kind for shot in shots]:
            self._spawn_cameras(shots)
        moved = [
            carla.command.ApplyTransform(camera.id, shot.transform)
            for (_, camera), shot in zip(self._cameras, shots, strict=True)
        ]
        self._simulator.client.apply_batch_sync(moved)
        frame = self._world.tick(self._simulator.timeout_s)
        try:
            measured = self._streams.wait(frame)
        except SensorSilentError as error:
            raise SimulatorError(f"{error}; the simulator may be busy, raise --timeout") from error
        return [_pixels(measured[str(number)][1]) for number in range(len(shots))]

    def _spawn_cameras(self, shots: Sequence[_Shot]) -> None:
        """Replace the present cameras by cameras of these kinds; each camera costs time in each step."""
        self._streams.stop()
        self._simulator.client.apply_batch_sync([carla.command.DestroyActor(each.id) for _, each in self._cameras])
        self._cameras = []
        for number, shot in enumerate(shots):
            blueprint = self._world.get_blueprint_library().find(CAMERA)
            for name, value in zip(("image_size_x", "image_size_y", "fov"), shot.kind, strict=True):
                blueprint.set_attribute(name, str(value))
            camera = self._world.spawn_actor(blueprint, shot.transform)
            self._cameras.append((shot.kind, camera))
            self._streams.listen(SpawnedSensor(str(number), camera.id, 1, as_numpy=False), camera)


def _shots(view: View) -> list[_Shot]:
    """Return the pictures of the simulator's cameras that a view needs, in the order of `_faces`."""
    if isinstance(view.lens, float):
        return [_Shot(view.width, view.height, view.lens, transform_of(optical_to_body(view.pose)))]
    lens = view.lens
    return [
        _Shot(lens.size_px, lens.size_px, lens.fov_deg, transform_of(optical_to_body(lens.pose(view.pose, name))))
        for name in lens.pixels
    ]


def _faces(view: View) -> list[str]:
    """Return the names of the pictures that a view needs."""
    return [""] if isinstance(view.lens, float) else list(view.lens.pixels)


def _picture(view: View, seen: Mapping[str, NDArray[np.uint8]]) -> NDArray[np.uint8]:
    """Return the picture of a view from those of the simulator's cameras."""
    if isinstance(view.lens, float):
        return seen[""]
    if not seen:  # the lens shows nothing
        return np.zeros((view.height, view.width, 3), np.uint8)
    return view.lens.picture(seen)


def _pixels(measured: carla.Image) -> NDArray[np.uint8]:
    """Return an image as (H, W, 3), red first."""
    raw = np.frombuffer(measured.raw_data, np.uint8).reshape(measured.height, measured.width, 4)
    return np.ascontiguousarray(raw[:, :, 2::-1])


def _away(number: int) -> carla.Transform:
    """Return where the actor with a number waits."""
    side = math.ceil(math.sqrt(number + 1))
    return carla.Transform(carla.Location(APART_M * (number % side), APART_M * side, AWAY_Z_M))
