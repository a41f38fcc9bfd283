"""The build of a sensor scene: the mesh of the map, the table of all faces, the ray caster.

Building it takes a second. So it begins in the background when a sensor that needs it is spawned. The first
measurement waits for the rest of it. The result does not depend on the time of the start.
"""

from functools import cache as once
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.background import in_background
from linden.maps.library import LoadedMap
from linden.physics.contact.statics import Statics
from linden.scenery.mesh import NO_OBJECT, Mesh
from linden.scenery.scene.objects import Scene
from linden.sensors.camera.cameras import CAMERAS
from linden.sensors.casting.caster import CPU, Caster
from linden.sensors.view import Faces, table_of

if TYPE_CHECKING:
    from linden.scenery.actors.actor_meshes import Bodies
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


def build(wanted: SceneKey, whole: Mesh, bodies: "Bodies", device: str) -> BuiltScene:
    """Return the scene. The caster is built in parallel to the tables that a colour picture needs."""
    # here, not above: a server without such sensors does not need it
    from linden.sensors.camera.picture.rgb import looks_of  # noqa: PLC0415 - see above
    from linden.sensors.casting.choose import caster_of  # noqa: PLC0415 - see above

    standing = present_of(whole, wanted.present)
    caster = in_background(lambda: caster_of(standing, bodies.meshes, device))
    if device == CPU:
        _load_kernels(pictures=False)
        if wanted.pictures:
            _load_kernels(pictures=True)
    faces = table_of(standing, bodies.meshes)
    looks_of(standing, bodies.meshes)
    return BuiltScene(wanted.scene, wanted.statics, standing, faces, caster.result(), wanted.pictures)


@once
def _load_kernels(*, pictures: bool) -> None:
    """Load the machine code of rays, or that of pictures, out of the cache: a start has it compiled."""
    from linden.sensors.warming import warm_cameras, warm_rays  # noqa: PLC0415 - as in build

    (warm_cameras if pictures else warm_rays)()


def present_of(mesh: Mesh, present: NDArray[np.bool_]) -> Mesh:
    """Return the mesh without the triangles of boxes that are not there."""
    thing = mesh.faces["object"]
    stays = np.append(present, [True])[np.where(thing == NO_OBJECT, len(present), thing)]
    return mesh if stays.all() else Mesh(mesh.vertices_m, mesh.triangles[stays], mesh.faces[stays])
