"""Street facts in, OpenDRIVE out: ``build`` puts network, junctions, controls and heights together."""

import itertools
import math
from collections import defaultdict
from typing import NamedTuple

from linden.errors import UserError
from linden_maps.streets import controls, crosswalks, junction_surfaces, junctions, roads, roundabouts
from linden_maps.streets.curves import Point, length, pose_at, seen_from
from linden_maps.streets.document import (
    Controller,
    Document,
    JunctionRecord,
    Link,
    Object,
    RoadRecord,
    Signal,
    SignalReference,
    value,
)
from linden_maps.streets.geojson import read
from linden_maps.streets.levels import crossings, lifts
from linden_maps.streets.name_signs import name_signs
from linden_maps.streets.network import End, Leg, Network
from linden_maps.streets.network import build as build_network
from linden_maps.streets.rails import rails
from linden_maps.streets.rings import ISLAND_RADIUS_M
from linden_maps.streets.standing import standing
from linden_maps.streets.street_facts import Control, Facts, Intersection
from linden_maps.streets.writing import text

FIRST_JUNCTION_ID = 1_000_000  # above all road ids: LibCarla takes a link to an unknown road for a junction
FIRST_CONTROLLER_ID = 2_000_000
MADE_UP = "made up: the street goes on outside of the map"


class Way(NamedTuple):
    """One connecting road or bend that leads from one end of a road to another's."""

    record: RoadRecord
    come: End
    go: End


class Built(NamedTuple):
    """A map and where its parts came from: which road an edge became (None inside a junction), and the ways between."""

    facts: Facts
    network: Network
    roads: tuple[RoadRecord | None, ...]
    ways: tuple[Way, ...]
    document: Document
    left_out: tuple[str, ...] = ()
    """Ids of buildings and furniture that would stand on a street."""
    simplified: tuple[str, ...] = ()
    """Ids of roundabouts that became plain junctions, because their island had no room."""
    over: tuple[tuple[str, str], ...] = ()
    """Ids of the streets that cross at different levels."""
    through: tuple[tuple[str, str], ...] = ()
    """Ids of the streets that cross at one level without a common point: traffic passes through each other."""


def build(streets: dict[str, object]) -> bytes:
    """Return OpenDRIVE 1.4 text for a street GeoJSON (docs/reference/maps.md); equal input gives equal bytes.

    Raises:
        UserError: the GeoJSON lacks something or holds what cannot be built; says which feature.
    """
    return text(assembled(read(streets)).document)


def assembled(facts: Facts) -> Built:
    """Return the map of the facts."""
    return _Assembly(facts).result()


class _Assembly:
    """Collects the parts of a map, junction by junction; numbers are given out in that order."""

    def __init__(self, facts: Facts) -> None:
        self.facts = facts
        self.network = build_network(facts)
        self.street_crossings = crossings(self.network)
        self.lifts_m = lifts(self.network, self.street_crossings)
        whole = [number for number, road in enumerate(self.network.roads) if road is not None]
        if not whole:
            names = ", ".join(street.id for street in facts.streets[:3])
            raise UserError(f"no road remains beside the junctions of the streets {names}; take a larger part")
        self.road_ids = {edge: i for i, edge in enumerate(whole, start=1)}
        self.way_ids = itertools.count(len(whole) + 1)
        self.signal_ids = itertools.count(1)
        self.object_ids = itertools.count(1)
        self.controller_ids = itertools.count(FIRST_CONTROLLER_ID)
        self.touches: dict[End, roads.Touch] = {}
        self.surfaces: dict[End, junction_surfaces.JunctionHeights] = {}
        self.meetings: dict[End, roads.HeightAndSlope] = {}
        self.signals: dict[int, list[Signal]] = defaultdict(list)
        self.objects: dict[int, list[Object]] = defaultdict(list)
        self.ways: list[Way] = []
        self.corners: list[RoadRecord] = []
        self.junctions: list[JunctionRecord] = []
        self.controllers: list[Controller] = []
        self.simplified: list[str] = []
        self.walked_ends, self.crossings = crosswalks.mapped_crossings(facts, self.network)

    def result(self) -> Built:
        walked = crosswalks.nodes_at_schools(self.facts, self.network)
        self._level(tuple(legs for nodes, legs in self.network.junctions if not self._is_bend(nodes, legs)))
        for nodes, legs in self.network.junctions:
            if self._is_bend(nodes, legs):
                self._add_bend((legs[0], legs[1]))
            else:
                self._add_junction(nodes, legs, walked)
        for edge, crosswalk in (
            *crosswalks.at_stops(self.facts, self.network, self.object_ids),
            *crosswalks.between_junctions(self.crossings, self.network, self.object_ids),
        ):
            self.objects[edge].append(crosswalk)
        placed = standing(self.facts, self.network)
        for edge, sign in controls.speed_signs(self.facts, self.network, self.signal_ids):  # last, so that ids stay
            self.signals[edge].append(sign)
        signs = name_signs(self.facts, self.network)
        for edge, thing in (*placed.objects, *rails(self.facts, self.network), *signs, *placed.signs):
            self.objects[edge].append(thing._replace(id=next(self.object_ids)))
        street_roads = tuple(self._street_road(edge) for edge in range(len(self.network.edges)))
        every = [road for road in street_roads if road is not None]
        every += sorted([way.record for way in self.ways] + self.corners, key=lambda road: road.id)
        document = Document(
            name=self.facts.name,
            geo_reference=(
                f"+proj=tmerc +lat_0={self.facts.latitude_deg} +lon_0={self.facts.longitude_deg} "
                "+k=1 +x_0=0 +y_0=0 +datum=WGS84 +units=m +no_defs"
            ),
            roads=tuple(every),
            controllers=tuple(self.controllers),
            junctions=tuple(self.junctions),
            notes=(("elevation_confidence", self.facts.ground.confidence),),
        )
        return Built(
            facts=self.facts,
            network=self.network,
            roads=street_roads,
            ways=tuple(self.ways),
            document=document,
            left_out=placed.left_out,
            simplified=tuple(self.simplified),
            over=self._crossing_streets(is_separated=True),
            through=self._crossing_streets(is_separated=False),
        )

    def _crossing_streets(self, *, is_separated: bool) -> tuple[tuple[str, str], ...]:
        """Return the ids of the streets that cross so without a common point."""
        edges = self.network.edges
        found = [one.edges for one in self.street_crossings if one.is_separated == is_separated]
        return tuple((edges[one].street.id, edges[other].street.id) for one, other in found)

    def _intersections(self, nodes: tuple[int, ...]) -> list[Intersection]:
        return [one for one in (self.network.nodes[node].intersection for node in nodes) if one is not None]

    def _is_bend(self, nodes: tuple[int, ...], legs: tuple[Leg, ...]) -> bool:
        """Return whether two roads merely go on in each other: as many lanes each way, and nothing to wait for."""
        if len(legs) != 2 or any(one.control is not Control.NONE for one in self._intersections(nodes)):
            return False
        come, go = legs[0].view, legs[1].view
        return all(len(come.driving(right=side)) == len(go.driving(right=not side)) for side in (False, True))

    def _level(self, junctions_legs: tuple[tuple[Leg, ...], ...]) -> None:
        """Lay out the surfaces of all junctions, and so the height and slope of each road where it meets one."""
        roads_m = [None if road is None else length(road) for road in self.network.roads]
        found = junction_surfaces.surfaces(self.facts.ground, junctions_legs, roads_m, self.lifts_m)
        for legs, surface in zip(junctions_legs, found, strict=True):
            for leg, end in zip(legs, surface.ends, strict=True):
                self.surfaces[leg.end] = surface
                self.meetings[leg.end] = end.height_m, end.slope if leg.end.at_end else -end.slope

    def _road_m(self, leg: Leg) -> float:
        road = self.network.roads[leg.end.edge]
        assert road is not None, "a leg is the end of a road"
        return length(road)

    def _add_bend(self, legs: tuple[Leg, Leg]) -> None:
        ids = self.road_ids[legs[0].end.edge], self.road_ids[legs[1].end.edge]
        record = roads.bend(next(self.way_ids), legs, ids, self.facts.ground, self.lifts_m[legs[0].node])
        self.ways.append(Way(record, legs[0].end, legs[1].end))
        self.touches[legs[0].end], self.touches[legs[1].end] = roads.touches_of_bend(record)

    def _add_junction(self, nodes: tuple[int, ...], legs: tuple[Leg, ...], crossings: frozenset[int]) -> None:
        found = self._intersections(nodes)
        number = FIRST_JUNCTION_ID + len(self.junctions)
        surface = self.surfaces[legs[0].end]
        for leg in legs:
            self.touches[leg.end] = roads.Touch(Link("junction", number), {})
        rules = [controls.control_of(found, self.network.nodes[leg.node].intersection) for leg in legs]
        centre = self.network.nodes[legs[0].node if len(legs) == 1 else nodes[0]].point
        turns, rules = self._turns(nodes, legs, rules, centre)
        is_roundabout = Control.ROUNDABOUT in rules
        connections, turn_ids = [], []
        for turn in turns:
            record = junctions.turn_road(next(self.way_ids), number, turn, self._ids(turn.come, turn.go))
            record = junction_surfaces.laid(record, surface)
            self.ways.append(Way(record, turn.come.end, turn.go.end))
            connections.append(junctions.connection(record))
            turn_ids.append(record.id)
        driven = junctions.surface(turns)
        kerb = roundabouts.circle_kerb(legs[0], centre) if len(legs) == 1 else None
        for come, go in zip(legs, (*legs[1:], legs[0]), strict=True):
            record = junctions.corner_road(next(self.way_ids), number, (come, go), self._ids(come, go), driven, kerb)
            self.corners.append(junction_surfaces.laid(record, surface))
            connections.append(junctions.connection(record))
        ranks = self._add_controls(legs, rules, found, walked=not crossings.isdisjoint(nodes))
        if Control.SIGNAL in rules:
            self._refer_to_lights(turns)
        if is_roundabout or len(legs) == 1:
            self._add_island(legs[0], centre, found)
            self.corners.append(junction_surfaces.laid(roundabouts.island(next(self.way_ids), centre), surface))
        self.junctions.append(
            JunctionRecord(
                id=number,
                name=" / ".join(one.name for one in found) or " & ".join(leg.street.name for leg in legs),
                connections=tuple(connections),
                priorities=_priorities(turns, turn_ids, ranks),
                controllers=self._add_controllers(legs) if Control.SIGNAL in rules else (),
                notes=controls.junction_notes(found, rules) if len(legs) > 1 else (("turning_circle", MADE_UP),),
            )
        )

    def _turns(
        self, nodes: tuple[int, ...], legs: tuple[Leg, ...], rules: list[Control], centre: Point
    ) -> tuple[tuple[junctions.Turn, ...], list[Control]]:
        """Return the ways through a junction and its rules: those of a plain one where its roundabout has no room.

        Raises:
            UserError: a roundabout has no room, and the facts do not allow to simplify it.
        """
        if len(legs) == 1:
            return roundabouts.turning_circle(legs[0], centre), rules
        if Control.ROUNDABOUT not in rules:
            return junctions.turns(legs), rules
        identity = next(one.id for one in self._intersections(nodes) if one.control is Control.ROUNDABOUT)
        why = "a roundabout needs more room to the next junction"
        if len(nodes) == 1:
            try:
                return roundabouts.turns(legs, centre), rules
            except UserError as error:
                why = str(error)
        if not self.facts.simplify_roundabouts:
            raise UserError(f"intersection {identity}: {why}")
        self.simplified.append(identity)
        return junctions.turns(legs), [Control.NONE] * len(rules)

    def _ids(self, come: Leg, go: Leg) -> tuple[int, int]:
        return self.road_ids[come.end.edge], self.road_ids[go.end.edge]

    def _add_controls(
        self, legs: tuple[Leg, ...], rules: list[Control], found: list[Intersection], *, walked: bool
    ) -> dict[End, int]:
        """Put signs, lines and crosswalks on the legs' roads; return 0 for legs without a sign, else 1."""
        ranks = {}
        confidence = found[0].control_confidence if found else "unknown"
        for leg, rule in zip(legs, rules, strict=True):
            intersection = self.network.nodes[leg.node].intersection
            kind = controls.sign_of(rule, leg, intersection.stops if intersection else frozenset())
            ranks[leg.end] = 0 if kind is None else 1
            road_m, edge = self._road_m(leg), leg.end.edge
            crosswalk = road_m >= controls.ROOM_FOR_CROSSWALK_M and (
                rule in {Control.SIGNAL, Control.ALL_WAY_STOP} or walked or leg.end in self.walked_ends
            )
            if crosswalk:
                self.objects[edge].append(controls.crosswalk(next(self.object_ids), leg, road_m, confidence))
            if kind is not None:
                self.objects[edge].append(
                    controls.line(next(self.object_ids), kind, leg, road_m, confidence, crosswalk=crosswalk)
                )
                self.signals[edge].append(
                    controls.signal(next(self.signal_ids), kind, leg, road_m, confidence, crosswalk=crosswalk)
                )
        return ranks

    def _refer_to_lights(self, turns: tuple[junctions.Turn, ...]) -> None:
        """Let each connecting road of the last junction refer to the light before it, as those of CARLA's towns do."""
        for number, turn in enumerate(turns, start=len(self.ways) - len(turns)):
            way = self.ways[number]
            reference = SignalReference(self._light_of(turn.come), (-1, -1))
            self.ways[number] = way._replace(record=way.record._replace(references=(reference,)))

    def _add_controllers(self, legs: tuple[Leg, ...]) -> tuple[int, ...]:
        """Return the ids of the controllers of a junction with lights: one for each approach.

        So have CARLA's towns: the approaches take turns, and no vehicle turns left through oncoming traffic. CARLA's
        Traffic Manager cannot do that without now and then blocking a junction for good.
        """
        ids = []
        for leg in legs:
            if leg.view.driving(right=True):
                ids.append(next(self.controller_ids))
                self.controllers.append(Controller(ids[-1], leg.street.name, (self._light_of(leg),)))
        return tuple(ids)

    def _light_of(self, leg: Leg) -> int:
        wanted = leg.view.driving(right=True)
        for signal in self.signals[leg.end.edge]:
            if signal.dynamic and signal.lanes == (min(wanted), max(wanted)):
                return signal.id
        raise AssertionError("every approach of a signalised junction has its light")

    def _add_island(self, leg: Leg, centre: Point, found: list[Intersection]) -> None:
        corners = [
            (
                centre[0] + ISLAND_RADIUS_M * math.cos(math.tau * i / 16),
                centre[1] + ISLAND_RADIUS_M * math.sin(math.tau * i / 16),
            )
            for i in (*range(16), 0)
        ]
        outline = tuple(seen_from(leg.pose, corner) for corner in corners)
        self.objects[leg.end.edge].append(
            controls.island(
                next(self.object_ids),
                leg,
                self._road_m(leg),
                outline,
                found[0].control_confidence if found else MADE_UP,
            )
        )

    def _street_road(self, edge: int) -> RoadRecord | None:
        path = self.network.roads[edge]
        if path is None:
            return None
        begin, end = End(edge, at_end=False), End(edge, at_end=True)
        one = self.network.edges[edge]
        ends = self.meetings.get(begin), self.meetings.get(end)
        lifts_m = self.lifts_m[one.nodes[0]], self.lifts_m[one.nodes[1]]
        heights = roads.elevation(self.facts.ground, path, ends, lifts_m)
        record = roads.street_road(self.road_ids[edge], one.street, one.section, path, heights)
        record = roads.linked(record, self.touches.get(begin), self.touches.get(end))
        return record._replace(signals=tuple(self.signals[edge]), objects=tuple(self.objects[edge]))


def off_ground_m(built: Built) -> tuple[float, float]:
    """Return by how many m roads leave the ground at most: away from junctions, and beside them."""
    ground, worst_m = built.facts.ground, [0.0, 0.0]
    for record in (road for road in built.roads if road is not None):
        total_m, ramp_m = length(record.path), ground.profile.ramp_m
        for i in range(int(total_m / 2.0) + 1):
            s_m = min(2.0 * i, total_m)
            pose = pose_at(record.path, s_m)
            apart_m = abs(value(record.elevation, s_m) - ground.height_m(pose.x_m, pose.y_m))
            is_near = min(s_m, total_m - s_m) < ramp_m
            worst_m[is_near] = max(worst_m[is_near], apart_m)
    return worst_m[0], worst_m[1]


def _priorities(
    turns: tuple[junctions.Turn, ...], ids: list[int], ranks: dict[End, int]
) -> tuple[tuple[int, int], ...]:
    """Return (first, second) for connecting roads in conflict where only the second comes from behind a sign."""
    pairs = zip(turns, ids, strict=True)
    high = [(turn, number) for turn, number in pairs if ranks[turn.come.end] == 0]
    low = [(turn, number) for turn, number in zip(turns, ids, strict=True) if ranks[turn.come.end] == 1]
    return tuple((a, b) for one, a in high for other, b in low if junctions.conflicting(one, other))
