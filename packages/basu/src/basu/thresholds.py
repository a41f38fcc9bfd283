"""Speeds at which BASU takes a road user for at rest, standing or moving, in m/s, and the height that wheels roll over.

The judgement uses the first two, BASU's own drivers and the actors of its cases the others too. The leaderboard's
constants stand in `basu.metrics.leaderboard`, and SUMO's in `basu_sumo.load`, because other programs define them.
"""

AT_REST_MPS = 0.1
"""Slower than this, a vehicle or a person is at rest: the leaderboard's figure for stop signs and collisions."""

IN_MOTION_MPS = 0.5
"""Faster than this, a road user takes part in traffic. Slower than this, it is an obstacle."""

STANDSTILL_MPS = 0.05
"""Slower than this, a vehicle has stopped completely: doors may open, and a following collision is not its fault."""

STANDING_TRAFFIC_MPS = 0.3
"""Slower than this, BASU's drivers take another vehicle for standing: they may pass it and need not wait for it."""

ROLLED_OVER_M = 0.2
"""A thing that is no higher than this, in m, does not obstruct: wheels roll over it, and no distance to it is judged.

It is the clearance under a vehicle's body in `linden`.
"""


def is_rolled_over(height_m: float) -> bool:
    """Return whether wheels roll over a thing of this height; a box without a height is not known to be low."""
    return 0.0 < height_m <= ROLLED_OVER_M
