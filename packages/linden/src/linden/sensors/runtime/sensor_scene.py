"""The scene that sensors see: the ray caster of the map, built on first use, and the visible actors."""

from collections.abc import Callable
from concurrent.futures import Future, wait
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from linden.background import Unwanted, in_background
from linden.blueprints.library import BlueprintKind
from linden.maps.library import LoadedMap
from linden.scenery.mesh import Mesh
from linden.scenery.scene.objects import Scene
from linden.sensors.casting.caster import CPU, Instances
from linden.sensors.runtime.light_state import LightStateCache
from linden.sensors.runtime.scene_key import BuiltScene, SceneKey, has_cameras
from linden.sensors.runtime.visible_actors import VisibleActors
from linden.sensors.view import NO_ACTOR_FROM, Seen

if TYPE_CHECKING:
    from linden.scenery.actors.actor_meshes import BlueprintMeshes
    from linden.sensors.camera.strokes import Strokes
    from linden.simulation.episode import Episode

U32 = NDArray[np.uint32]

OBJECTS_FROM = NO_ACTOR_FROM + 0x8000
"""Ids of objects that are no actors begin here: no actor has one, nor one that is the same in its lowest 16 bits."""

_OF_SIGNALS = (BlueprintKind.TRAFFIC_LIGHT, BlueprintKind.TRAFFIC_SIGN)


def standing_on(world_map: LoadedMap, scene: Scene) -> Mesh:
    """Return what stands on a map; made anew each time."""
    from linden.scenery import map_mesh  # noqa: PLC0415 - 50 ms that a server without such sensors does without

    return map_mesh.standing_on(world_map, scene)


def _read_bodies() -> "BlueprintMeshes":
    from linden.scenery.actors.actor_meshes import actor_meshes  # noqa: PLC0415 - as in standing_on

    return actor_meshes()


class SensorScene:
    """Lets sensors see an episode; outlives it, since most loads load the same map again.

    Nothing is built before a sensor that looks is there, and no body gathered before it is listened to.

    Attributes:
        standing_on: gives the mesh of what stands on a map, anew or out of a cache.
        when_built: called when what was being built is there, or will not be; by any thread.
        await_kernels: waits until the kernels of rays are compiled, or those of pictures (True) too.
        is_compiling: tells whether kernels of pictures are still being compiled.
        device: where rays are cast: "cpu", or a GPU as Warp names it, "cuda".
    """

    def __init__(self) -> None:
        self.standing_on: Callable[[LoadedMap, Scene], Mesh] = standing_on
        self.device = CPU
        self.when_built: Callable[[], None] = lambda: None
        self.await_kernels: Callable[[bool], None] = lambda pictures: None  # noqa: ARG005 - all are compiled
        self.is_compiling: Callable[[], bool] = lambda: False
        self._bodies: Future[BlueprintMeshes] | None = None
        self._visible_actors: VisibleActors | None = None
        self._whole: tuple[Scene, Mesh] | None = None
        self._scene: BuiltScene | None = None
        self._coming: tuple[SceneKey, Future[BuiltScene]] | None = None
        self._unwanted: Unwanted | None = None
        self._episode: Episode | None = None
        self._signals: tuple[Episode, U32] | None = None
        self._light_states = LightStateCache()
        self._standing_strokes: tuple[LoadedMap, Scene, NDArray[np.bool_], Strokes, Strokes] | None = None
        self._frame = -1
        self._instances: Instances | None = None

    def prepare(self, episode: "Episode") -> None:
        """Begin to build what is not built yet, in the background: a sensor that looks was spawned."""
        if not self._is_built(episode) and (self._coming is None or not self._coming[0].is_for(episode)):
            wanted = SceneKey.of(episode, pictures=not self.is_compiling())
            before, bodies = self._coming, self._bodies_coming()
            self._scene = None  # before the next is built: two of them at once would take twice the memory
            self._give_up()
            self._unwanted = unwanted = Unwanted()
            self._coming = wanted, in_background(lambda: self._built(wanted, bodies, before), unwanted)
            self._coming[1].add_done_callback(lambda _: self.when_built())

    def leave(self, episode: "Episode") -> None:
        """Give up what is being built, and let go of what is, unless an episode that begins wants the same."""
        if self._coming is not None and not self._coming[0].is_for(episode):
            self._give_up()
            self._coming = None
        if self._scene is not None and self._scene.scene is not episode.surroundings.scene:
            self._scene = self._whole = None
        if episode is not self._episode:
            self._episode = self._instances = self._visible_actors = self._signals = None

    def _give_up(self) -> None:
        if self._unwanted is not None:
            self._unwanted.set()

    def wait(self, at_most_s: float) -> bool:
        """Wait for what is being built, if anything is, but no longer than that; return whether all is there."""
        return self._coming is None or not wait([self._coming[1]], at_most_s).not_done

    def follow(self, episode: "Episode", frame: int) -> Instances:
        """Note where the bodies are in a frame; to be called in every frame while a sensor that looks is listened to.

        So the next frame knows where they came from, whether or not a sensor measures in this one.
        """
        if self._instances is None or episode is not self._episode or frame != self._frame:
            if self._visible_actors is None or episode is not self._episode:
                self._visible_actors = VisibleActors(self._all_bodies())
            self._instances = self._visible_actors.gather(episode, goes_on=frame == self._frame + 1)
            self._episode, self._frame = episode, frame
        return self._instances

    def look(self, episode: "Episode", frame: int) -> Seen:
        """Return the moment as it is seen, the bodies posed; builds what is not built yet."""
        instances, scene = self.follow(episode, frame), self._scene_of(episode)
        scene.caster.pose(instances)
        if self._signals is None or self._signals[0] is not episode:
            self._signals = episode, _object_ids(episode)  # lights and signs are there as long as the episode
        light_states = self._light_states.of(episode)
        return Seen(
            caster=scene.caster,
            standing=scene.standing,
            bodies=self._all_bodies().meshes,
            faces=scene.faces,
            instances=instances,
            object_id=self._signals[1],
            object_lights=light_states.lights,
            object_light_colour=light_states.colour,
            weather=episode.weather,
            now_s=episode.elapsed_s,
        )

    def standing_strokes(self, episode: "Episode") -> "Strokes":
        """Return the lines of a map and of what stands on it, made anew where the map or what stands there changed.

        On a town that takes seconds, which the first picture of a camera of lines waits for.
        """
        loaded, scene, present = episode.map, episode.surroundings.scene, episode.surroundings.present
        kept = self._standing_strokes
        if kept is None or kept[0] is not loaded or kept[1] is not scene or not np.array_equal(kept[2], present):
            from linden.sensors.camera.strokes import joined  # noqa: PLC0415 - as in standing_on
            from linden.sensors.runtime.outlines import map_strokes, scenery_strokes  # noqa: PLC0415 - likewise

            of_map = kept[3] if kept is not None and kept[0] is loaded else map_strokes(loaded.text, loaded.ground)
            strokes = joined([of_map, scenery_strokes(scene, present)])
            self._standing_strokes = kept = loaded, scene, present.copy(), of_map, strokes
        return kept[4]

    def _all_bodies(self) -> "BlueprintMeshes":
        return self._bodies_coming().result()

    def _bodies_coming(self) -> "Future[BlueprintMeshes]":
        if self._bodies is None:
            self._bodies = in_background(_read_bodies)
        return self._bodies

    def _is_built(self, episode: "Episode") -> bool:
        here = episode.surroundings
        scene = self._scene
        is_here = scene is not None and scene.scene is here.scene and scene.statics is here.statics
        return is_here and scene is not None and (scene.pictures or not has_cameras(episode))

    def _scene_of(self, episode: "Episode") -> BuiltScene:
        """Return the built scene, without hidden layers and objects."""
        self.prepare(episode)
        if self._coming is not None:
            coming, self._coming = self._coming[1], None
            self._scene = coming.result()
        assert self._scene is not None
        return self._scene

    def _built(
        self, wanted: SceneKey, bodies: "Future[BlueprintMeshes]", before: "tuple[SceneKey, Future[BuiltScene]] | None"
    ) -> BuiltScene:
        """Return the wanted scene, after the build of the previous one has ended."""
        if before is not None:
            wait([before[1]])
        if self._whole is None or self._whole[0] is not wanted.scene:
            self._whole = wanted.scene, self.standing_on(wanted.world_map, wanted.scene)
        self.await_kernels(wanted.pictures)
        from linden.sensors.runtime.scene_build import build  # noqa: PLC0415 - 50 ms, as in standing_on

        return build(wanted, self._whole[1], bodies.result(), self.device)


def _object_ids(episode: "Episode") -> U32:
    """Return the id of each box of the scene: its actor's, where lights and signs are actors, or one above them all."""
    things = episode.surroundings.scene.boxes["thing"]
    signal_ids = np.array([record.id for record in episode.actors if record.kind in _OF_SIGNALS], np.uint32)
    ids = (OBJECTS_FROM + np.arange(len(things))).astype(np.uint32)
    of_actors = things < len(signal_ids)
    ids[of_actors] = signal_ids[things[of_actors]]
    return ids
