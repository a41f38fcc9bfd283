"""Street-name signs: one post at a corner of each junction, with a blade for each street that meets there.

The Manual on Uniform Traffic Control Devices (FHWA, 2009) asks for such signs at all intersections in towns, two feet
behind the kerb (sections 2D.43 and 2A.19). The corner is a choice of the builder, so no fact says that a sign stands
there. Streets without a known name get no blade.
"""

import math
from collections.abc import Iterator

from linden_maps.streets.controls import (
    LINE_TO_END_M,
    POST_TO_KERB_M,
    ROOM_FOR_CROSSWALK_M,
    line_before_end_m,
)
from linden_maps.streets.cross_section import KERB_M
from linden_maps.streets.curves import length
from linden_maps.streets.document import Object
from linden_maps.streets.network import Leg, Network
from linden_maps.streets.street_facts import Facts, Street

POST_HALF_M = 0.03  # a round steel post of 2 3/8 in
HEIGHT_M = 2.8  # two blades of 6 in above 2.4 m; section 2A.18 asks for 7 ft below the lower one
KIND, NAME, BLADE = "pole", "StreetNameSign", "streetName"
PLACE_NAME = "PlaceNameSign"  # name of the objects with a building's name, which `standing` makes
_UNKNOWN = "unverified"  # what the facts say of a name that is a description


def name_signs(facts: Facts, network: Network) -> Iterator[tuple[int, Object]]:
    """Yield the signs (numbered 0) with the edge that each belongs to, none where the facts do not want them."""
    if not facts.street_name_signs:
        return
    for _, legs in network.junctions:
        streets = {leg.street.name: leg for leg in legs if _is_known(leg.street)}
        if len(legs) > 2 and len(streets) > 1:
            yield _sign(network, _corner(legs), tuple(streets.items()), facts.street_name_signs)


def _turn_rad(leg: Leg, along_rad: float) -> float:
    """Return how far a blade for a leg's street is turned against a road, in (-pi / 2, pi / 2] and never -0."""
    return round(math.pi / 2 - (math.pi / 2 - leg.pose.heading_rad + along_rad) % math.pi, 3) + 0.0


def _is_known(street: Street) -> bool:
    return dict(street.confidences).get("name_confidence") != _UNKNOWN


def _corner(legs: tuple[Leg, ...]) -> Leg:
    """Return the leg to the right of the sign: one that shares this corner with a street of another name."""
    pairs = zip(legs, (legs[-1], *legs[:-1]), strict=True)  # counter-clockwise, so the leg before is on the left
    known = [(leg, left) for leg, left in pairs if _is_known(leg.street)]
    return min(known, key=lambda pair: (not _is_known(pair[1].street), pair[0].street.name == pair[1].street.name))[0]


def _sign(network: Network, leg: Leg, streets: tuple[tuple[str, Leg], ...], confidence: str) -> tuple[int, Object]:
    """Return a sign left of a leg, beyond the crosswalk where one has room; each blade is parallel to its street."""
    road = network.roads[leg.end.edge]
    assert road is not None, "a leg is the end of a road"
    road_m = length(road)
    before_m = line_before_end_m(crosswalk=True) if road_m >= ROOM_FOR_CROSSWALK_M else LINE_TO_END_M
    beside_m = leg.view.kerb_m(right=False) + KERB_M + POST_TO_KERB_M
    along_rad = leg.pose.heading_rad if leg.end.at_end else leg.pose.heading_rad + math.pi
    half = POST_HALF_M
    return leg.end.edge, Object(
        0,
        NAME,
        KIND,
        s_m=road_m - before_m if leg.end.at_end else before_m,
        t_m=beside_m if leg.end.at_end else -beside_m,
        heading_rad=0.0,
        outline=((-half, -half), (half, -half), (half, half), (-half, half), (-half, -half)),
        confidence=confidence,
        height_m=HEIGHT_M,
        notes=tuple((BLADE, f"{_turn_rad(other, along_rad):.3f} {name}") for name, other in streets),
    )
