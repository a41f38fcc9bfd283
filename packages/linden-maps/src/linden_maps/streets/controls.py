"""Traffic control as OpenDRIVE records: signs, lights, stop lines, crosswalks and roundabout islands."""

from collections.abc import Iterator

from linden_maps.streets.cross_section import KERB_M, PAVED, View, view
from linden_maps.streets.curves import length
from linden_maps.streets.document import Object, Signal
from linden_maps.streets.network import Leg, Network
from linden_maps.streets.rings import ISLAND_RADIUS_M, LANE_M
from linden_maps.streets.street_facts import Control, Facts, Intersection, Street

STOP, YIELD, LIGHT, SPEED_LIMIT = "206", "205", "1000001", "274"  # LibCarla's SignalType
SPEED_SIGN_M = 25.0  # from where a road begins; estimated
ROOM_FOR_SPEED_SIGN_M = 50.0
LINE_TO_END_M = 0.8  # from the junction to the middle of a stop line without crosswalk
CROSSWALK_TO_END_M = 0.8
CROSSWALK_M = 3.0  # 10 ft, a usual width; MUTCD 3B.18 asks for 6 ft at least
LINE_TO_CROSSWALK_M = 1.4  # to the line's middle; MUTCD 3B.16 asks for 4 ft of free road between them
LINE_WIDTH_M = 0.4  # MUTCD 3B.16: 12 to 24 in
POST_TO_KERB_M = 0.6  # MUTCD 2A.19: 2 ft from the kerb's face
CLEAR_WIDTHS = 0.7  # LibCarla moves a signal that is nearer to the middle of a lane than this share of its width
CLEAR_M = 0.05
ROOM_FOR_CROSSWALK_M = 14.0  # a road that is shorter gets none
NO_LIGHTS = "made up: all-way stop in place of lights"


def without_lights(facts: Facts) -> Facts:
    """Return facts with an all-way stop wherever they have lights, as in the map of the thesis (section 5.2.1).

    Drivers stop at dark lights and go on by the rules of an all-way stop (Ohio Revised Code 4511.132).
    """
    changed = tuple(
        one._replace(control=Control.ALL_WAY_STOP, control_confidence=NO_LIGHTS)
        if one.control is Control.SIGNAL
        else one
        for one in facts.intersections
    )
    return facts._replace(intersections=changed)


def control_of(intersections: list[Intersection], intersection: Intersection | None) -> Control:
    """Return what governs a leg: a light or roundabout anywhere in the junction, else its own intersection's rule."""
    for control in (Control.SIGNAL, Control.ROUNDABOUT):
        if any(one.control is control for one in intersections):
            return control
    return intersection.control if intersection else Control.NONE


def sign_of(control: Control, leg: Leg, stops: frozenset[str]) -> str | None:
    """Return the type of the sign or light for traffic that enters on a leg, None where it needs none."""
    if not leg.view.driving(right=True):
        return None
    if control in {Control.TWO_WAY_STOP, Control.GIVE_WAY}:
        waits = leg.street.name in stops or leg.street.id in stops
        return None if not waits else STOP if control is Control.TWO_WAY_STOP else YIELD
    return {Control.SIGNAL: LIGHT, Control.ALL_WAY_STOP: STOP, Control.ROUNDABOUT: YIELD}.get(control)


def _clear_of_lanes_m(view: View) -> float:
    """Return how far beyond the right kerb a post has to stand so that LibCarla leaves it there."""
    paved_m = needed_m = 0.0
    for _, lane in view.right:
        if lane.kind in PAVED:
            if lane.kind != "parking":
                needed_m = paved_m + (0.5 + CLEAR_WIDTHS) * lane.width_m
            paved_m += lane.width_m
    return needed_m + CLEAR_M - paved_m


def signal(number: int, kind: str, leg: Leg, road_m: float, confidence: str, *, crosswalk: bool) -> Signal:
    """Return the sign or light of a leg: at the stop line, right of the kerb, valid for the incoming lanes."""
    lanes = leg.view.driving(right=True)
    before_m = line_before_end_m(crosswalk=crosswalk)
    beside_m = leg.view.kerb_m(right=True) - max(KERB_M + POST_TO_KERB_M, _clear_of_lanes_m(leg.view))
    name = {STOP: "Stop", YIELD: "Yield", LIGHT: "Signal"}[kind]
    return Signal(
        id=number,
        name=f"{name}, {leg.street.name}",
        s_m=road_m - before_m if leg.end.at_end else before_m,
        t_m=beside_m if leg.end.at_end else -beside_m,
        kind=kind,
        lanes=(min(lanes), max(lanes)),
        confidence=confidence,
        dynamic=kind == LIGHT,
    )


def speed_sign(number: int, street: Street, seen: View, road_m: float, *, along: bool) -> Signal:
    """Return the sign of a street's limit, right of the kerb, for traffic that enters a road seen in its direction."""
    lanes = seen.driving(right=True)
    beside_m = seen.kerb_m(right=True) - max(KERB_M + POST_TO_KERB_M, _clear_of_lanes_m(seen))
    return Signal(
        id=number,
        name=f"Speed limit, {street.name}",
        s_m=SPEED_SIGN_M if along else road_m - SPEED_SIGN_M,
        t_m=beside_m if along else -beside_m,
        kind=SPEED_LIMIT,
        lanes=(min(lanes), max(lanes)),
        confidence=dict(street.confidences).get("speed_confidence", "unknown"),
        value=street.speed_limit.value,
        unit=street.speed_limit.unit,
    )


def line(number: int, kind: str, leg: Leg, road_m: float, confidence: str, *, crosswalk: bool) -> Object:
    """Return the stop or yield line across a leg's incoming lanes."""
    lanes = leg.view.driving(right=True)
    inner_m = leg.view.axis_m
    width_m = sum(leg.view.lane(lane).width_m for lane in lanes)
    middle_m = inner_m - width_m / 2
    return _across(
        number,
        "YieldLine" if kind == YIELD else "StopLine",
        "roadMark",
        leg,
        (road_m, line_before_end_m(crosswalk=crosswalk), middle_m),
        (LINE_WIDTH_M, width_m),
        confidence,
    )


def crosswalk(number: int, leg: Leg, road_m: float, confidence: str) -> Object:
    """Return the crosswalk over a leg, from kerb to kerb."""
    right_m, left_m = leg.view.kerb_m(right=True), leg.view.kerb_m(right=False)
    return _across(
        number,
        "Crosswalk",
        "crosswalk",
        leg,
        (road_m, CROSSWALK_TO_END_M + CROSSWALK_M / 2, (right_m + left_m) / 2),
        (CROSSWALK_M, left_m - right_m),
        confidence,
    )


def crosswalk_at(number: int, view_along: View, s_m: float, confidence: str) -> Object:
    """Return a crosswalk between junctions, ``s_m`` along a road seen in its own direction."""
    right_m, left_m = view_along.kerb_m(right=True), view_along.kerb_m(right=False)
    outline = _rectangle(CROSSWALK_M, left_m - right_m)
    return Object(number, "Crosswalk", "crosswalk", s_m, (right_m + left_m) / 2, 0.0, outline, confidence)


def island(number: int, leg: Leg, road_m: float, outline: tuple[tuple[float, float], ...], confidence: str) -> Object:
    """Return the central island of a roundabout as an object of one leg's road; the outline as that leg sees it."""
    return Object(
        number,
        "RoundaboutIsland",
        "trafficIsland",
        road_m if leg.end.at_end else 0.0,
        0.0,
        0.0 if leg.end.at_end else 3.141592653589793,
        outline,
        confidence,
    )


def line_before_end_m(*, crosswalk: bool) -> float:
    """Return how far before the end of its road a stop line's middle lies."""
    return CROSSWALK_TO_END_M + CROSSWALK_M + LINE_TO_CROSSWALK_M if crosswalk else LINE_TO_END_M


def junction_notes(found: list[Intersection], rules: list[Control]) -> tuple[tuple[str, str], ...]:
    """Return what a reader of the file may want to know: where it comes from, how sure it is, what governs it."""
    order = list(Control)
    control = min(rules, key=order.index)
    notes = [("control", control.value)]
    for one in found:
        notes += [
            ("intersection", one.id),
            ("confidence", one.confidence),
            ("control_confidence", one.control_confidence),
        ]
    if control is Control.ROUNDABOUT:
        notes += [
            ("roundabout", "mini"),
            ("island_radius_m", str(ISLAND_RADIUS_M)),
            ("lane_width_m", str(LANE_M)),
        ]
    return tuple(notes)


def _across(
    number: int,
    name: str,
    kind: str,
    leg: Leg,
    place: tuple[float, float, float],
    size_m: tuple[float, float],
    confidence: str,
) -> Object:
    """Return a painted rectangle over a leg. ``place``: the road's length, m before its end, m left of its line."""
    road_m, before_m, left_m = place
    return Object(
        number,
        name,
        kind,
        s_m=road_m - before_m if leg.end.at_end else before_m,
        t_m=left_m if leg.end.at_end else -left_m,
        heading_rad=0.0,
        outline=_rectangle(*size_m),
        confidence=confidence,
    )


def _rectangle(along_m: float, across_m: float) -> tuple[tuple[float, float], ...]:
    """Return a closed outline about its middle: LibCarla's readers expect the first corner again at the end."""
    u, v = along_m / 2, across_m / 2
    return ((-u, -v), (u, -v), (u, v), (-u, v), (-u, -v))


def speed_signs(facts: Facts, network: Network, ids: Iterator[int]) -> Iterator[tuple[int, Signal]]:
    """Yield an edge and a sign where each street with a posted limit begins, in both directions."""
    for street in facts.streets:
        if not street.speed_posted:
            continue
        edges = [number for number, edge in enumerate(network.edges) if edge.street.id == street.id]
        roads_m = {number: length(road) for number in edges if (road := network.roads[number]) is not None}
        room = [number for number in roads_m if roads_m[number] >= ROOM_FOR_SPEED_SIGN_M]
        for along, number in ((True, room[0]), (False, room[-1])) if room else ():
            seen = view(network.edges[number].section, along=along)
            if seen.driving(right=True):
                yield number, speed_sign(next(ids), street, seen, roads_m[number], along=along)
