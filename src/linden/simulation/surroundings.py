"""What of a scene changes while an episode runs: what is there, how its lamps stand, what clients drew into it."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from linden.scene.debug_shapes import DebugShapes
from linden.scene.lamps import Lamps
from linden.scene.objects import Kind
from linden.simulation.scenery import Scenery, solid
from linden.values.enums import MapLayer
from linden.values.episode import LightState


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
            whole = scene.things["kind"][thing] != Kind.TRAFFIC_LIGHT
            self._enabled[scene.boxes_of(thing) if whole else box] = enabled
        self._refresh()
        return unknown

    def load_layers(self, layers: int) -> None:
        """Let layers appear, bits of MapLayer; what was disabled in them is enabled again, as after any load."""
        coming = self.scene.layers & layers & ~int(self._layers)
        self._enabled |= coming != 0
        self._change_layers(self._layers | MapLayer(layers & MapLayer.ALL))

    def unload_layers(self, layers: int) -> None:
        """Let layers disappear, bits of MapLayer."""
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
        """Begin a frame at a simulated time: shapes whose time is over go, and clients are told of lamps."""
        self.debug.step(now_s)
        self.lamps.turn_page()
