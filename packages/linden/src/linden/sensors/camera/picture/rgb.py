"""The colour picture of one view, stage after stage."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.protocol.values.space import Transform
from linden.scenery.mesh import Mesh
from linden.sensors.camera.labels import FAR_M
from linden.sensors.camera.picture.atmosphere import Air, air
from linden.sensors.camera.picture.edges import edge_rays, finer, smooth
from linden.sensors.camera.picture.film import developed
from linden.sensors.camera.picture.lamps import LampGrid, LampGroup, StandingLamps, groups, lamps_near, standing_lamps
from linden.sensors.camera.picture.shade import shaded
from linden.sensors.camera.picture.smooth_normals import Relief, joined, relief, without_first
from linden.sensors.camera.picture.sun_shadows import Sunshine, sunny, within
from linden.sensors.camera.picture.surface_points import Places
from linden.sensors.camera.spec import CameraSpec, Film
from linden.sensors.casting.caster import Hits, Rays
from linden.sensors.view import LINEAR, Seen, first_of_places

F32 = NDArray[np.float32]


BRIGHTEST = 2.0
"""Light above counts as this where a pixel's samples are put together, or edges would glitter."""


class Looks(NamedTuple):
    """What pictures need to know of the meshes besides their faces; made once for a map."""

    relief: Relief
    standing_lamps: StandingLamps
    body_lamps: tuple[tuple[LampGroup, ...], ...]


_made: list[tuple[Mesh, Sequence[Mesh], Looks]] = []
"""The last one made, for the meshes it was made of."""


def looks_of(standing: Mesh, bodies: Sequence[Mesh]) -> Looks:
    """Return the looks of meshes; those of the last ones are kept, and those of the same bodies taken over."""
    if not _made or _made[0][0] is not standing or _made[0][1] is not bodies:
        if _made and _made[0][1] is bodies:
            of_bodies, body_lamps = _of_bodies(*_made[0])
        else:
            of_bodies, body_lamps = relief(bodies), tuple(groups(mesh, standing=False) for mesh in bodies)
        made = Looks(joined([relief([standing]), of_bodies]), standing_lamps(standing), body_lamps)
        _made[:] = [(standing, bodies, made)]
    return _made[0][2]


def _of_bodies(standing: Mesh, _: Sequence[Mesh], looks: Looks) -> tuple[Relief, tuple[tuple[LampGroup, ...], ...]]:
    """Return what looks hold of the bodies, without what stands: objects of a map come and go, the bodies stay."""
    return without_first(looks.relief, len(standing.triangles)), looks.body_lamps


class Light(NamedTuple):
    """What lights a moment, and where what it lights is."""

    air: Air
    looks: Looks
    places: Places
    lamps: LampGrid


def picture(spec: CameraSpec, film: Film, pose: Transform, rays: Rays, hits: Hits, seen: Seen) -> NDArray[np.uint8]:
    """Return (height, width, 4) bytes B, G, R, A of what a camera at ``pose`` sees along its rays."""
    lit = light_of(pose, seen, places_of(seen))
    pixel_rad = 1.0 / spec.focal_px
    sun = sunny(seen.caster, rays, hits, lit.air)
    light = shone(rays, hits, sun, pixel_rad, lit, seen)
    rows = edge_rays(spec, hits, light)
    if len(rows):
        fine = finer(spec, rows, pose)
        met = seen.caster.closest(fine, FAR_M, coherent=True, outer=True)
        sun = sunny(seen.caster, fine, met, lit.air, within(spec, rows, sun))
        smooth(rows, shone(fine, met, sun, 0.5 * pixel_rad, lit, seen), BRIGHTEST, light)
    return developed(spec, film, light, lit.air)


def shone(rays: Rays, hits: Hits, sun: Sunshine, pixel_rad: float, lit: Light, seen: Seen) -> F32:
    """Return the light (N, 3) that comes along each ray; ``pixel_rad`` is how wide a ray's pixel is."""
    return shaded(rays, hits, sun.lit, pixel_rad, seen.faces, lit.looks.relief, lit.places, lit.air, lit.lamps)


def light_of(pose: Transform, seen: Seen, places: Places) -> Light:
    """Return what lights what a camera at ``pose`` sees; ``places`` are the same for all cameras of a moment."""
    looks = looks_of(seen.standing, seen.bodies)
    lamps = lamps_near(np.array(pose.location), seen, looks.standing_lamps, looks.body_lamps)
    return Light(air(seen.weather, seen.now_s), looks, places, lamps)


def places_of(seen: Seen) -> Places:
    """Return what pictures know of what stands and of each body."""
    bodies = seen.instances
    world = np.concatenate([np.eye(3, 4, dtype=np.float32)[None], bodies.pose])
    back = np.empty_like(world)
    scale2 = np.einsum("ki,ki->k", world[:, :, 0], world[:, :, 0])  # poses turn, and scale evenly
    turned = world[:, :, :3].transpose(0, 2, 1) / scale2[:, None, None]
    back[:, :, :3], back[:, :, 3] = turned, -np.einsum("kij,kj->ki", turned, world[:, :, 3])
    return Places(
        first_of_places(seen.faces, bodies),
        np.ascontiguousarray(world),
        back,
        np.concatenate([np.zeros((1, 3), np.float32), LINEAR[bodies.colour]]),
        np.concatenate([np.zeros(1, np.uint32), bodies.lights]),
        seen.object_lights,
    )
