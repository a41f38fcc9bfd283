"""Lots: the pieces of land along a street on which something may stand.

A table by itself, so that who only reads it needs none of what cuts them (:mod:`linden.world.map_cutting`).
"""

import numpy as np

LOTS = np.dtype(
    [
        ("front_m", "f8", 2),  # the middle of the side on the street, x and y
        ("yaw_rad", "f8"),  # from the street into the lot
        ("road_id", "i4"),
    ]
)

LOT_WIDTH_M = 11
"""Along the street; lots of South Linden are 33 to 40 feet wide."""
LOT_DEPTH_M = 20
"""Away from the street: as much of a lot as its front yard and its house take; what lies behind is left open."""
