"""The build of a sensor scene: the mesh of the map, the table of all faces, the ray caster.

Building it takes a second. So it begins in the background when a sensor that needs it is spawned. The first
measurement waits for the rest of it. The result does not depend on the time of the start.
"""

from functools import cache as once

import numpy as np
from numpy.typing import NDArray

from linden.background import in_background
from linden.scenery.actors.actor_meshes import BlueprintMeshes
from linden.scenery.mesh import NO_OBJECT, Mesh
from linden.sensors.camera.picture.rgb import looks_of
from linden.sensors.casting.caster import CPU
from linden.sensors.casting.choose import caster_of
from linden.sensors.runtime.scene_key import BuiltScene, SceneKey
from linden.sensors.view import table_of
from linden.sensors.warming import warm_cameras, warm_rays


def build(wanted: SceneKey, whole: Mesh, bodies: BlueprintMeshes, device: str) -> BuiltScene:
    """Return the scene. The caster is built in parallel to the tables that a colour picture needs."""
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
    (warm_cameras if pictures else warm_rays)()


def present_of(mesh: Mesh, present: NDArray[np.bool_]) -> Mesh:
    """Return the mesh without the triangles of boxes that are not there.

    Where less than half of it is left, the vertices of the rest go as well: casters and pictures go through all.
    """
    thing = mesh.faces["object"]
    stays = np.append(present, [True])[np.where(thing == NO_OBJECT, len(present), thing)]
    if stays.all():
        return mesh
    triangles, faces = mesh.triangles[stays], mesh.faces[stays]
    if 2 * len(triangles) > len(mesh.triangles):
        return Mesh(mesh.vertices_m, triangles, faces)
    used = np.zeros(len(mesh.vertices_m), np.bool_)
    used[triangles] = True
    row = np.cumsum(used, dtype=mesh.triangles.dtype) - 1
    return Mesh(mesh.vertices_m[used], row[triangles], faces)
