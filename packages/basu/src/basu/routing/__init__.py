"""From a route file to a path along the lanes: read it, join its points, find the signs on the way."""

from basu.routing.plan import plan
from basu.routing.planned_route import Control, ControlKind, Route, Stop

__all__ = ["Control", "ControlKind", "Route", "Stop", "plan"]
