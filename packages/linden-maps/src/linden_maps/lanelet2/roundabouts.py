"""Roundabouts as format 2 of autoware_lanelet2_extension has them: one element for each, with its lanelets by role.

A roundabout of the map is one junction, and each way through it is one lanelet from an arm to an arm. So the lanelets
inside are ``internal``, the lanelets before it ``entry`` and the lanelets behind it ``exit``.
"""

from linden.maps.opendrive.model import OpenDrive
from linden_maps.lanelet2.draft import LaneletDraft
from linden_maps.lanelet2.model import Member
from linden_maps.lanelet2.movements import Movement

FORMAT_VERSION = "2"
"""Of a file with such elements; Autoware that knows format 1 alone does not load it."""


def add_roundabouts(opendrive: OpenDrive, draft: LaneletDraft, movements: dict[int, list[Movement]]) -> None:
    """Add the element of every roundabout; the lanelets that lead in and those inside refer to it."""
    for junction, found in movements.items():
        record = opendrive.junction_by_id.get(junction)
        if record is None or "roundabout" not in dict(record.user_data):
            continue
        inside = [movement.stretch for movement in found]
        entries = sorted({origin for movement in found for origin in movement.origins} - set(inside))
        exits = sorted({after for way in inside for after in draft.network.successors[way]} - set(inside))
        roles = (("entry", entries), ("exit", exits), ("internal", inside))
        members = [Member("relation", draft.lanelet_of[nth], role) for role, ways in roles for nth in ways]
        draft.add_element("roundabout", members, [draft.lanelet_of[nth] for nth in (*entries, *inside)], junction)
