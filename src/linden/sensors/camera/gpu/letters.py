"""What a GPU is told for each frame and picture, as arrays that go there together."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.geometry import rotation_matrix
from linden.sensors.camera import motion
from linden.sensors.camera.picture import develop
from linden.sensors.camera.picture.atmosphere import Air
from linden.sensors.camera.picture.rgb import Light
from linden.sensors.camera.picture.spots import Places
from linden.sensors.camera.spec import Film
from linden.sensors.looking import Look
from linden.sensors.seen import Seen, first_of_places, id_of_places
from linden.values.space import Transform

Letters = dict[str, NDArray[Any]]
Array = Any
"""An array of numba's on the GPU."""

AIR = np.dtype([(name, "f4") if kind is float else (name, "f4", 3) for name, kind in Air.__annotations__.items()])
"""``Air`` as the GPU has it."""


class Lit(NamedTuple):
    """What lights a view, as the GPU has it; see ``rgb.Light``."""

    places: Places
    sun: Array  # (3,)
    air: Array  # (1,) of AIR
    corner: Array  # (2,) of the grid of lamps
    lamps: tuple[Array, Array, Array]
    factor: Array  # (3,)
    rain: Array  # (3,)
    view: Array  # (3, 4)


def of_light(light: Light, film: Film, pose: Transform) -> Letters:
    """Return what lights a view, and what a film makes of it."""
    air, grid = light.air, light.lamps
    return {
        "sun": np.array([air.sun_x, air.sun_y, air.sun_z], np.float32),
        "air": np.array([tuple(air)], AIR),
        "corner": np.array([grid.west_m, grid.north_m], np.float32),
        "first": grid.first,
        "number": grid.number,
        "lamps": grid.lamps,
        "factor": develop.balance(film, air),
        "rain": np.array(develop.rain(air), np.float64),
        "view": posed(pose),
    }


def lit(places: Places, sent: dict[str, Array]) -> Lit:
    """Return what ``of_light`` has become on the GPU."""
    lamps = sent["first"], sent["number"], sent["lamps"]
    return Lit(places, lamps=lamps, **{name: sent[name] for name in ("sun", "air", "corner", "factor", "rain", "view")})


def of_owners(seen: Seen) -> Letters:
    """Return the first face and the actor of each place, and the id of each object."""
    return {
        "first": first_of_places(seen.faces, seen.instances),
        "actor_id": id_of_places(seen.instances),
        "object_id": seen.object_id,
    }


def of_motion(look: Look) -> Letters:
    """Return where bodies and the camera came from."""
    before, now = motion.eye(look.before), motion.eye(look.pose)
    return {
        "carried": motion.carried_back(look.seen.instances),
        "places_m": np.array([before.place_m, now.place_m]),
        "turns": np.array([before.turn, now.turn]),
    }


def posed(pose: Transform) -> NDArray[np.float32]:
    """Return (3, 4): how a camera is turned, and where it is."""
    return np.column_stack([rotation_matrix(pose.rotation), pose.location]).astype(np.float32)
