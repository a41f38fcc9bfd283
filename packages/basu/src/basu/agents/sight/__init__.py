"""Visibility of other actors to a vehicle: line of sight, occlusion, and range by light and weather, with a memory.

An agent asks for them with ``self.visible_actors()`` or holds a :class:`Sight` of its own.
"""

from basu.agents.sight.actors import ActorKind, Other
from basu.agents.sight.line_of_sight import MEMORY_S, RADIUS_M, Knowledge, Sight

__all__ = ["MEMORY_S", "RADIUS_M", "ActorKind", "Knowledge", "Other", "Sight"]
