"""From a route file to a path along the lanes: read it, join its points, find the signs on the way."""

from basu.routing.model import Control, ControlKind, Route, Stop
from basu.routing.plan import plan

__all__ = ["Control", "ControlKind", "Route", "Stop", "plan"]
