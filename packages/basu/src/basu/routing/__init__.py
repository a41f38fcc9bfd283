"""From a route file to a path along the lanes: read it, join its points, find the signs on the way."""

from basu.routing.plan import plan
from basu.routing.planned_route import ControlKind, Route, RouteControl, Stop

__all__ = ["ControlKind", "Route", "RouteControl", "Stop", "plan"]
