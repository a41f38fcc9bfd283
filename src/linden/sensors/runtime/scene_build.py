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


class SceneKey(NamedTuple):
    """The input of a build, and the key of the cached result: the map, its scene, and the boxes that are present."""

    world_map: LoadedMap
    scene: Scene
    statics: Statics
    present: NDArray[np.bool_]

    @classmethod
    def of(cls, episode: "Episode") -> "SceneKey":
        """Return what an episode's sensors want now."""
        here = episode.surroundings
        return cls(episode.map, here.scene, here.statics, here.present.copy())

    def is_for(self, episode: "Episode") -> bool:
        """Return whether this is still what an episode's sensors want."""
        here = episode.surroundings
        return self.scene is here.scene and self.statics is here.statics


def build(wanted: SceneKey, whole: Mesh, bodies: "Bodies", device: str) -> BuiltScene:
    """Return the stage: the caster built beside the rest of it, which a colour picture needs."""
    # here, not above: a server without such sensors does not need it
    from linden.sensors.camera.picture.rgb import looks_of  # noqa: PLC0415 - see above
    from linden.sensors.casting.choose import caster_of  # noqa: PLC0415 - see above

    standing = present_of(whole, wanted.present)
    caster = in_background(lambda: caster_of(standing, bodies.meshes, device))
    if device == CPU:
        _load_kernels()
    faces = table_of(standing, bodies.meshes)
    looks_of(standing, bodies.meshes)
    return BuiltScene(wanted.scene, wanted.statics, standing, faces, caster.result())


@once
def _load_kernels() -> None:
    """Load what a first picture needs of machine code, out of the cache, where a start compiled everything."""
    from linden.sensors.warming import warm_up  # noqa: PLC0415 - as in build

    warm_up()


def present_of(mesh: Mesh, present: NDArray[np.bool_]) -> Mesh:
    """Return the mesh without the triangles of boxes that are not there."""
    thing = mesh.faces["object"]
    stays = np.append(present, [True])[np.where(thing == NO_OBJECT, len(present), thing)]
    return mesh if stays.all() else Mesh(mesh.vertices_m, mesh.triangles[stays], mesh.faces[stays])
