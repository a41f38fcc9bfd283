"""`Scenery`, a map's fixed scene that episodes share, and `Surroundings`, the objects, lamps and shapes of one episode.

Every map has its lights and signs and the scene that they are part of. Clients hide and show objects, switch lamps and
draw debug shapes.
"""

from collections.abc import Iterable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.maps.library import GENERATED_MAP, HOME_MAPS, LoadedMap
from linden.physics.contact.statics import STATIC_BOX, Statics
from linden.protocol.values.enums import MapLayer
from linden.protocol.values.episode import LightState
from linden.scenery.scene.debug_shapes import DebugShapes
from linden.scenery.scene.lamp_states import Lamps
from linden.scenery.scene.mapped import mapped, plain
from linden.scenery.scene.objects import ObjectKind, Scene, join
from linden.scenery.scene.posts import Post, posts, walls
from linden.scenery.scene.south_linden import home
from linden.traffic.signal_actors import NO_LIGHT, Signals


class Scenery(NamedTuple):
    """What every episode on a map begins with; nothing in it ever changes.

    The first things of the scene are those of the signals' actors, in their order.
    """

    signals: Signals
    scene: Scene
    statics: Statics


@lru_cache(maxsize=1)
def scenery_of(world_map: LoadedMap) -> Scenery:
    """Return the scenery of a map; the last one is kept, for most loads load the same map again.

    Of Linden it is known what stands beside its streets; other maps have plainer houses where there is room. What a
    client sent as OpenDRIVE has none, as in CARLA: lights, signs, and the walls of its request.
    """
    signals = Signals.of(world_map.signals, world_map.controllers, world_map.give_way)
    standing = [Post(actor.transform, actor.light != NO_LIGHT) for actor in signals.actors]
    scene = posts(standing, world_map.ground)
    if len(world_map.walls.feet_m):
        scene = join([scene, walls(*world_map.walls)])
    if world_map.name in HOME_MAPS:
        scene = join([scene, home(world_map)])
    elif world_map.name != GENERATED_MAP:
        scene = join([scene, plain(world_map)])
    if world_map.standing and world_map.name not in {*HOME_MAPS, GENERATED_MAP}:
        scene = join([scene, mapped(world_map.standing)])
    return Scenery(signals, scene, solid(scene, np.ones(len(scene.boxes), bool)))


def solid(scene: Scene, present: NDArray[np.bool_]) -> Statics:
    """Return the boxes of a scene that are present as physics takes them; their ids are their rows in the scene."""
    rows = np.flatnonzero(present)
    if not len(rows):
        return Statics.none()
    boxes = np.zeros(len(rows), STATIC_BOX)
    for name in ("centre", "half", "yaw_rad", "tag"):
        boxes[name] = scene.boxes[name][rows]
    boxes["id"] = rows
    return Statics.of(boxes)


class Surroundings:
    """The scene of one episode.

    Attributes:
        scene: all things and boxes that the map has.
        statics: the boxes that are there, as physics takes them; replaced whole.
        lamps: how the lamps stand.
        debug: what clients have drawn.
    """

    def __init__(self, scenery: Scenery) -> None:
        """Begin with everything there."""
        self.scene, self.statics = scenery.scene, scenery.statics
        self.lamps = Lamps(scenery.scene)
        self.debug = DebugShapes()
        self._enabled = np.ones(len(self.scene.boxes), bool)
        self._layers = MapLayer.ALL

    @property
    def loaded(self) -> NDArray[np.bool_]:
        """Which boxes (N,) belong to a layer that is loaded, or to none; others do not exist for any client."""
        layers = self.scene.layers
        loaded: NDArray[np.bool_] = (layers == int(MapLayer.NONE)) | ((layers & int(self._layers)) != 0)
        return loaded

    @property
    def present(self) -> NDArray[np.bool_]:
        """Which boxes (N,) are there: loaded and enabled."""
        present: NDArray[np.bool_] = self.loaded & self._enabled
        return present

    def enable(self, object_ids: Iterable[int], *, enabled: bool) -> list[int]:
        """Let objects appear or disappear; returns the ids that no loaded object has.

        As in CARLA a thing appears and disappears as a whole (ObjectRegister.cpp, EnableActor), but the parts of a
        traffic light one by one.
        """
        scene, loaded, unknown = self.scene, self.loaded, []
        for object_id in object_ids:
            box = scene.box_of_id.get(object_id, -1)
            if box < 0 or not loaded[box]:
                unknown.append(object_id)
                continue
            thing = int(scene.boxes["thing"][box])
            whole = scene.things["kind"][thing] != ObjectKind.TRAFFIC_LIGHT
            self._enabled[scene.boxes_of(thing) if whole else box] = enabled
        self._refresh()
        return unknown

    def load_layers(self, layers: int) -> None:
        """Let layers appear, bits of MapLayer; what was disabled in them is enabled again, as after any load."""
        coming = self.scene.layers & layers & ~int(self._layers)
        self._enabled |= coming != 0
        self._change_layers(self._layers | MapLayer(layers & MapLayer.ALL))

    def unload_layers(self, layers: int) -> None:
        """Hide the map layers of the bits of MapLayer in ``layers``."""
        self._change_layers(self._layers & ~MapLayer(layers & MapLayer.ALL))

    def _change_layers(self, layers: MapLayer) -> None:
        if (layers ^ self._layers) & MapLayer.STREET_LIGHTS:
            self.lamps.tell()
        if layers != self._layers:
            self._layers = layers
            self._refresh()

    def lamp_states(self) -> tuple[LightState, ...]:
        """Return the lamps that are loaded."""
        return self.lamps.states() if self._layers & MapLayer.STREET_LIGHTS else ()

    def _refresh(self) -> None:
        self.statics = solid(self.scene, self.present)

    def step(self, now_s: float) -> None:
        """Begin a frame at a simulated time: drop expired shapes, and announce changed lamps to clients."""
        self.debug.step(now_s)
        self.lamps.turn_page()
