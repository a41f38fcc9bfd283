"""Posts of traffic lights and signs, and walls beside roads, as boxes of the scene.

Sizes are those of the Manual on Uniform Traffic Control Devices (FHWA, 2009): a sign's plate hangs at least 7 feet
above the pavement (section 2A.18), a signal's face at least 8 feet (section 4D.15), and has three lenses of 12 inches.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.maps.ground import Ground
from linden.protocol.values.enums import SemanticTag
from linden.protocol.values.space import Transform
from linden.scenery.scene.objects import ObjectKind, Scene, assembled, boxes_on, join, things_with

POST_HALF_WIDTH_M = 0.05
"""Half the width of a sign's square steel post, and about that of a light's pole where a bumper meets it."""

POST_HEIGHT_M = 2.5

PLATE_HALF_M = (0.375, 0.01, 0.375)
"""A stop sign of 30 inches; across the lanes along x, as CARLA's models stand."""
PLATE_BOTTOM_M = 2.13

HEAD_HALF_M = (0.18, 0.15, 0.53)
"""Three lenses in their housing, on top of the pole."""

HIGHEST_M = 7.8
"""A light hangs at most 25.6 feet above its pavement (section 4D.15). Ground further down is under a bridge."""


class Post(NamedTuple):
    """Where a light or sign of the map stands."""

    transform: Transform
    is_light: bool


def posts(placed: Sequence[Post], ground: Ground) -> Scene:
    """Return the scene of lights and signs: first all lights, then all signs, in their order.

    They stand on the ground, or at the edge of the bridge of their road.

    Raises:
        ValueError: a light comes after a sign.
    """
    lights = sum(post.is_light for post in placed)
    if any(post.is_light for post in placed[lights:]):
        raise ValueError("lights come before signs, so that a thing's number is that of its actor")
    return join(
        [
            _posts(placed[:lights], ground, ObjectKind.TRAFFIC_LIGHT),
            _posts(placed[lights:], ground, ObjectKind.TRAFFIC_SIGN),
        ]
    )


def _posts(placed: Sequence[Post], ground: Ground, kind: ObjectKind) -> Scene:
    base = np.array([post.transform.location for post in placed], np.float64).reshape(-1, 3)
    under_m, _ = ground.surfaces_under(base)
    base[:, 2] = np.where(base[:, 2] - under_m > HIGHEST_M, base[:, 2], under_m)
    things = things_with(kind, base, np.radians([post.transform.rotation.yaw for post in placed]))
    half = np.array([POST_HALF_WIDTH_M, POST_HALF_WIDTH_M, 0.5 * POST_HEIGHT_M])
    pole = boxes_on(things, np.array([0.0, 0.0, half[2]]), half, SemanticTag.POLES)
    if kind is ObjectKind.TRAFFIC_LIGHT:
        above = np.array([0.0, 0.0, POST_HEIGHT_M + HEAD_HALF_M[2]])
        return assembled(things, pole, boxes_on(things, above, np.array(HEAD_HALF_M), SemanticTag.TRAFFIC_LIGHT))
    on_it = np.array([0.0, 0.0, PLATE_BOTTOM_M + PLATE_HALF_M[2]])
    return assembled(things, pole, boxes_on(things, on_it, np.array(PLATE_HALF_M), SemanticTag.TRAFFIC_SIGNS))


F64 = NDArray[np.float64]

HALF_THICKNESS_M = 0.02
"""CARLA's walls are sheets without thickness; a box needs some."""


def walls(feet_m: F64, height_m: float) -> Scene:
    """Return walls of a height over pieces (N, 2, 3) of their feet, from and to."""
    begin, end = feet_m[:, 0], feet_m[:, 1]
    middle, ahead = 0.5 * (begin + end), end - begin
    middle[:, 2] = np.minimum(begin[:, 2], end[:, 2])
    things = things_with(ObjectKind.WALL, middle, np.arctan2(ahead[:, 1], ahead[:, 0]))
    half = 0.5 * np.column_stack(
        [np.hypot(ahead[:, 0], ahead[:, 1]), np.zeros(len(ahead)), abs(ahead[:, 2]) + height_m]
    )
    half[:, 1] = HALF_THICKNESS_M
    return assembled(things, boxes_on(things, half * (0.0, 0.0, 1.0), half, SemanticTag.WALLS))
