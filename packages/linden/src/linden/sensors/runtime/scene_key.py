"""A built sensor scene, and its key: what decides whether a scene must be built anew."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.maps.library import LoadedMap
from linden.physics.contact.statics import Statics
from linden.scenery.mesh import Mesh
from linden.scenery.scene.objects import Scene
from linden.sensors.camera.cameras import CAMERAS
from linden.sensors.casting.caster import Caster
from linden.sensors.view import Faces

if TYPE_CHECKING:
    from linden.simulation.episode import Episode


class BuiltScene(NamedTuple):
    """A scene for sensors, cached as long as the map's scene and its present boxes (``statics``) stay the same."""

    scene: Scene
    statics: Statics
    standing: Mesh
    faces: Faces
    caster: Caster
    pictures: bool  # whether what cameras need is loaded


class SceneKey(NamedTuple):
    """The input of a build and the key of the cached result: map, scene, present boxes, and whether cameras need it."""

    world_map: LoadedMap
    scene: Scene
    statics: Statics
    present: NDArray[np.bool_]
    pictures: bool

    @classmethod
    def of(cls, episode: "Episode", *, pictures: bool) -> "SceneKey":
        """Return what an episode's sensors want now; ``pictures``: even if no camera is there yet."""
        here = episode.surroundings
        return cls(episode.map, here.scene, here.statics, here.present.copy(), pictures or has_cameras(episode))

    def is_for(self, episode: "Episode") -> bool:
        """Return whether this is still what an episode's sensors want."""
        here = episode.surroundings
        is_here = self.scene is here.scene and self.statics is here.statics
        return is_here and (self.pictures or not has_cameras(episode))


def has_cameras(episode: "Episode") -> bool:
    """Return whether a camera is among the actors of an episode."""
    return any(record.description.id in CAMERAS for record in episode.actors)
