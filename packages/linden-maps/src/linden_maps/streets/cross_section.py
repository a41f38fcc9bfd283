"""``Section``: the cross-section of a street, with lane types and widths on both sides and the axis offset.

Widths are authored between the kerbs; ``docs/decisions/0010-cross-sections.md`` says how they are shared out.
"""

from typing import NamedTuple

from linden_maps.streets.street_facts import Street

PARKING_M = 2.1  # 7 ft
CYCLE_LANE_M = 1.5  # 5 ft, the least that NACTO's Urban Bikeway Design Guide asks for
NARROWEST_LANE_M = 2.85  # a 2.0 m shuttle and 0.4 m on either side
KERB_M = 0.15
VERGE_M = 1.2
SIDEWALK_M = 1.5  # 5 ft, on which two wheelchairs pass
KERB_HEIGHT_M = 0.15
PAVED = frozenset({"driving", "biking", "parking", "shoulder"})
RAISED = frozenset({"border", "none", "sidewalk"})


class Lane(NamedTuple):
    """A strip of one kind; ``kind`` is OpenDRIVE's lane type."""

    kind: str
    width_m: float


class Section(NamedTuple):
    """Lanes right and left of the axis, from it outward; ``axis_m``: how far left of the centre-line it runs."""

    right: tuple[Lane, ...]
    left: tuple[Lane, ...]
    axis_m: float

    def paved_m(self, side: tuple[Lane, ...]) -> float:
        """Return the width from the axis to the kerb on one side."""
        return sum(lane.width_m for lane in side if lane.kind in PAVED)


class View(NamedTuple):
    """A section seen in the direction of travel towards a junction; lanes with their OpenDRIVE ids.

    ``axis_m`` is measured to the left of the road's reference line, in the traveller's frame.
    """

    right: tuple[tuple[int, Lane], ...]
    left: tuple[tuple[int, Lane], ...]
    axis_m: float

    def inner_edge_m(self, lane_id: int) -> float:
        """Return how far left of the reference line the lane's edge nearest to the axis runs."""
        at_m = self.axis_m
        for number, lane in self.right:
            if number == lane_id:
                return at_m
            at_m -= lane.width_m
        at_m = self.axis_m
        for number, lane in self.left:
            if number == lane_id:
                return at_m
            at_m += lane.width_m
        raise KeyError(lane_id)

    def middle_m(self, lane_id: int, *, right: bool) -> float:
        """Return how far left of the reference line the middle of a lane of one side runs."""
        half_m = self.lane(lane_id).width_m / 2
        return self.inner_edge_m(lane_id) + (-half_m if right else half_m)

    def lane(self, lane_id: int) -> Lane:
        """Return the lane with that id."""
        return dict(self.right + self.left)[lane_id]

    def kerb_m(self, *, right: bool) -> float:
        """Return how far left of the reference line the kerb's face stands (negative on the right)."""
        paved_m = sum(lane.width_m for _, lane in (self.right if right else self.left) if lane.kind in PAVED)
        return self.axis_m - paved_m if right else self.axis_m + paved_m

    def edge_m(self, *, right: bool) -> float:
        """Return how far left of the reference line the outermost lane ends (negative on the right)."""
        width_m = sum(lane.width_m for _, lane in (self.right if right else self.left))
        return self.axis_m - width_m if right else self.axis_m + width_m

    def driving(self, *, right: bool) -> tuple[int, ...]:
        """Return the ids of the driving lanes of one side, from the axis outward."""
        return tuple(number for number, lane in (self.right if right else self.left) if lane.kind == "driving")

    def raised(self, *, right: bool) -> tuple[tuple[int, Lane], ...]:
        """Return kerb, verge and sidewalk of one side, from the road outward."""
        return tuple((number, lane) for number, lane in (self.right if right else self.left) if lane.kind in RAISED)


def view(section: Section, *, along: bool) -> View:
    """Return the section as seen by a traveller along the road (``along``) or against it."""
    right = tuple((-number, lane) for number, lane in enumerate(section.right, start=1))
    left = tuple((number, lane) for number, lane in enumerate(section.left, start=1))
    return View(right, left, section.axis_m) if along else View(left, right, -section.axis_m)


def of_street(street: Street) -> Section:
    """Share a street's width out among its lanes.

    Parking (a shoulder where parking is limited) lies on both sides where the lanes keep 3.0 m, else on the right side
    in the direction of the street's points, else nowhere. Cycle lanes run between the driving lanes and what is parked.
    What remains is the driving lanes', in equal parts.
    """
    right_count = street.lanes if street.oneway else street.lanes_forward or (street.lanes + 1) // 2
    left_count = street.lanes - right_count
    edge_kind = "parking" if street.parking == "both" else "shoulder"
    cycled = _cycled(street)
    edges = _edges(street, right_count + left_count, street.width_m - CYCLE_LANE_M * sum(cycled))
    lane_m = round((street.width_m - PARKING_M * sum(edges) - CYCLE_LANE_M * sum(cycled)) / street.lanes, 3)
    driving = Lane("driving", lane_m)
    edge = Lane(edge_kind, PARKING_M)
    cycle = Lane("biking", CYCLE_LANE_M)
    right = (driving,) * right_count + (cycle,) * cycled[0] + (edge,) * edges[0]
    left = (driving,) * left_count + (cycle,) * cycled[1] + (edge,) * edges[1]
    paved_right_m = lane_m * right_count + CYCLE_LANE_M * cycled[0] + PARKING_M * edges[0]
    return Section(
        right=right + _roadside(walk=street.sidewalk != "none"),
        left=left + _roadside(walk=street.sidewalk == "both"),
        axis_m=round(paved_right_m - street.width_m / 2, 6),
    )


def _cycled(street: Street) -> tuple[int, int]:
    """Return whether a cycle lane lies on the right and on the left: on the left only where traffic drives there."""
    is_right = street.cycle_lanes != "none"
    return int(is_right), int(street.cycle_lanes == "both" and not street.oneway)


def _edges(street: Street, lanes: int, width_m: float) -> tuple[int, int]:
    """Return whether a parking lane or shoulder lies on the right and on the left."""
    if lanes >= 4 or (street.parking == "none" and not street.oneway):
        return 0, 0
    if not street.oneway and width_m - 2 * PARKING_M >= 3.0 * lanes:
        return 1, 1
    return int(width_m - PARKING_M >= NARROWEST_LANE_M * lanes), 0


def _roadside(*, walk: bool) -> tuple[Lane, ...]:
    kerb = (Lane("border", KERB_M),)
    return (*kerb, Lane("none", VERGE_M), Lane("sidewalk", SIDEWALK_M)) if walk else kerb
