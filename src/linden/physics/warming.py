"""Compile at a moment of one's own choosing: when installing, not when the first vehicle waits."""

import numpy as np

from linden.maps.ground import Ground, surface_under
from linden.physics.bodies import Bodies
from linden.physics.contact.statics import Statics
from linden.physics.step import advance


def warm_up() -> None:
    """Compile, or load from the cache, all that a server calls: the ground and a frame of physics."""
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    ground = Ground.from_triangles(corners, [[0, 1, 2]])
    surface_under(ground, 0.1, 0.1, 0.0)
    ground.surfaces_under([[0.1, 0.1, 0.0]])
    advance(Bodies(), ground, Statics.none(), 0.01)
