"""The end of a drive along a route: the rule that a run applies to each frame, as a function of numbers.

`basu.managers.routes_manager` puts it into words. `linden_gym` compiles it for many vehicles at once.
"""

from __future__ import annotations

from basu.metrics.delays import BLOCKED_S
from basu.metrics.validity import LOST_M
from basu.outcome import Status

GOES_ON, ARRIVED, LEFT_OUT, STOPPED, LOST, BLOCKED, TIMED_OUT = range(7)

STATUS_OF = {
    ARRIVED: Status.COMPLETED,
    LEFT_OUT: Status.ROUTE_DEVIATION,  # at the end of the route, of which a piece was not driven
    STOPPED: Status.STOPPED,
    LOST: Status.ROUTE_DEVIATION,
    BLOCKED: Status.ROUTE_BLOCKED,
    TIMED_OUT: Status.ROUTE_TIMEOUT,
}


def ending_of(
    arrived: bool,  # noqa: FBT001 - compiled
    gaps: int,
    distance_m: float,
    still_s: float,
    t_s: float,
    limit_s: float,
    stop_s: float,
) -> int:
    """Return how a drive ends with a frame, `GOES_ON` if it does not.

    Args:
        arrived: whether the vehicle is at the end of the route in a frame that counts.
        gaps: pieces of the route that were not driven.
        distance_m: from the route.
        still_s: since the vehicle last moved.
        t_s: since the drive began.
        limit_s: time for the route.
        stop_s: time after which the user stops the drive; inf for never.
    """
    if arrived:
        return LEFT_OUT if gaps else ARRIVED
    if t_s >= stop_s:
        return STOPPED
    if distance_m > LOST_M:
        return LOST
    if still_s > BLOCKED_S:
        return BLOCKED
    return TIMED_OUT if t_s > limit_s else GOES_ON
