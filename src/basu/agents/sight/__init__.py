"""What a driver can see: the actors in line of sight, within the range that light and weather leave.

An agent asks for them with ``self.visible_actors()`` or holds a :class:`Sight` of its own.
"""

from basu.agents.sight.actors import Kind, Other
from basu.agents.sight.line_of_sight import MEMORY_S, RADIUS_M, Knowledge, Sight

__all__ = ["MEMORY_S", "RADIUS_M", "Kind", "Knowledge", "Other", "Sight"]
