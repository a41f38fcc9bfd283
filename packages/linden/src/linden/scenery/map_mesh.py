"""Everything that stands on a map, as one mesh: the streets, the land, and the things of the scene in their places."""

import numpy as np
from numpy.typing import NDArray

from linden.background import checkpoint
from linden.maps.facts import MapFacts
from linden.maps.ground import Ground
from linden.maps.library import LoadedMap
from linden.maps.opendrive.mesh import road_mesh
from linden.maps.opendrive.model import OpenDrive
from linden.maps.opendrive.parse import parse
from linden.maps.records import NAMES_BETWEEN, STREET_NAME_SIGN
from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import Material, Mesh, join
from linden.scenery.patches import ALL_SIDES, PatchFrames, PatchLook, boxes
from linden.scenery.roadside.buildings import buildings, furniture
from linden.scenery.roadside.houses import houses, plans
from linden.scenery.roadside.name_signs import blades_with_names, posts
from linden.scenery.roadside.parked_cars import parked_cars
from linden.scenery.roadside.signal_posts import signs, street_lamps, traffic_lights
from linden.scenery.roadside.trees import Planted, trees, woods
from linden.scenery.roadside.wires import shelters, utility_poles
from linden.scenery.roadside.yards import fences, hedges, paved_yards, porches
from linden.scenery.scene.linden_survey import surveyed
from linden.scenery.scene.objects import ObjectKind, Scene
from linden.scenery.scene.south_linden import free_lots
from linden.scenery.scene.woodland import far_from_roads
from linden.scenery.streets.junction_floors import floors
from linden.scenery.streets.markings import lines
from linden.scenery.streets.railroad import railroad
from linden.scenery.streets.road import CONCRETE, kerbs, surface
from linden.scenery.streets.road_paint import across_lanes, arrows
from linden.scenery.streets.simplified_lanes import SimplifiedLanes, simplified_lanes
from linden.scenery.streets.terrain import land

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

_SEED = 880


def standing_on(world_map: LoadedMap, scene: Scene) -> Mesh:
    """Return what stands on a loaded map; see :func:`standing`."""
    return standing(parse(world_map.text), world_map, scene)


def standing(opendrive: OpenDrive, facts: MapFacts, scene: Scene) -> Mesh:
    """Return what stands: triangles of things name their box in ``scene``, those of the streets and the land none."""
    lanes = simplified_lanes(opendrive)
    checkpoint()
    under = floors(road_mesh(opendrive), facts.ground)
    checkpoint()
    lawn = land(lanes, facts.ground, under)
    return join([streets(lanes, opendrive, facts), under.mesh, lawn, _beside(facts, scene, lawn), things(facts, scene)])


def _beside(facts: MapFacts, scene: Scene, lawn: Mesh) -> Mesh:
    """Return what only Linden has and what is nothing to run into: drives, paths, the railroad."""
    if not (scene.things["kind"] == ObjectKind.SHELTER).any():
        return join([])
    line = surveyed(facts.geo_origin_deg).railroad_m
    under = Ground.from_triangles(lawn.vertices_m, lawn.triangles)
    return join(
        [
            paved_yards(free_lots(facts), scene, facts.ground, under),
            railroad(line, facts.ground, under),
            woods(scene, facts.ground),
        ]
    )


def streets(lanes: SimplifiedLanes, opendrive: OpenDrive, facts: MapFacts) -> Mesh:
    """Return the roads with their kerbs and paint."""
    return join(
        [
            surface(lanes),
            kerbs(lanes, facts.ground),
            lines(lanes),
            across_lanes(opendrive, facts),
            arrows(opendrive, facts),
        ]
    )


def things(facts: MapFacts, scene: Scene) -> Mesh:
    """Return the things of the scene."""
    parts = []
    for kind, make in _MAKERS.items():
        rows = np.flatnonzero(scene.things["kind"] == kind)
        if len(rows):
            checkpoint()
            parts.append(make(_Of(facts, scene, rows)))
    return join(parts)


class _Of:
    """The things of one kind: where they stand and what their boxes are."""

    def __init__(self, facts: MapFacts, scene: Scene, rows: NDArray[np.intp]) -> None:
        self.facts = facts
        self.things = scene.things[rows]
        self.frames = PatchFrames(self.things["base"], self.things["yaw_rad"])
        self._first = np.searchsorted(scene.boxes["thing"], rows).astype(np.int32)
        self._boxes = scene.boxes
        self.every_box = np.flatnonzero(np.isin(scene.boxes["thing"], rows)).astype(np.int32)
        self.boxes = scene.boxes[self.every_box]
        kind = int(self.things["kind"][0])
        self.draw = np.random.default_rng([_SEED, kind]).random((len(rows), 8))

    def box(self, nth: int) -> I32:
        """Return the row of the nth box of each thing."""
        return self._first + np.int32(nth)

    def half_m(self, nth: int) -> F64:
        """Return half the size (N, 3) of the nth box of each thing."""
        half: F64 = self._boxes["half"][self.box(nth)]
        return half


def _lights(of: _Of) -> Mesh:
    return traffic_lights(of.frames, of.box(0), of.box(1))


def _signs(of: _Of) -> Mesh:
    known = {signal.transform.location[:2]: (signal.type, signal.value) for signal in of.facts.signals}
    kinds = [known.get((x, y), ("", None)) for x, y, _ in of.things["base"].tolist()]
    return signs(of.frames, kinds, of.box(0), of.box(1))


def _houses(of: _Of) -> Mesh:
    return houses(of.frames, plans(of.half_m(0), of.draw, of.box(0)))


def _trees(of: _Of) -> Mesh:
    half = of.half_m(0)
    planted = Planted(of.frames, half[:, 0], 2.0 * half[:, 2], of.draw, of.box(0))
    return trees(planted, ~far_from_roads(of.frames.base_m[:, :2], of.facts.ground))


def _lamps(of: _Of) -> Mesh:
    return street_lamps(of.frames, of.box(0), of.box(1))


def _walls(of: _Of) -> Mesh:
    half = of.half_m(0)
    return boxes(
        of.frames,
        half * (0.0, 0.0, 1.0),
        half,
        PatchLook(Material.CONCRETE, SemanticTag.WALLS, CONCRETE, of.box(0)),
        ALL_SIDES,
    )


def _porches(of: _Of) -> Mesh:
    return porches(of.frames, of.half_m(0), of.box(0))


def _hedges(of: _Of) -> Mesh:
    return hedges(of.frames, of.half_m(0), of.draw, of.box(0))


def _fences(of: _Of) -> Mesh:
    return fences(of.frames, of.half_m(0), of.draw, of.box(0))


def _parked(of: _Of) -> Mesh:
    return parked_cars(of.frames, of.half_m(0), of.draw, of.box(0))


def _poles(of: _Of) -> Mesh:
    return utility_poles(of.frames, of.box(0))


def _shelters(of: _Of) -> Mesh:
    return shelters(of.frames, of.box(0))


def _buildings(of: _Of) -> Mesh:
    feet = of.boxes["centre"] - of.boxes["half"] * (0.0, 0.0, 1.0)
    return buildings(PatchFrames(feet, of.boxes["yaw_rad"]), of.boxes["half"], of.boxes["thing"], of.every_box)


def _benches(of: _Of) -> Mesh:
    return furniture("bench", of.frames, of.half_m(0), of.box(0))


def _bins(of: _Of) -> Mesh:
    return furniture("bin", of.frames, of.half_m(0), of.box(0))


def _mailboxes(of: _Of) -> Mesh:
    return furniture("mailbox", of.frames, of.half_m(0), of.box(0))


def _name_signs(of: _Of) -> Mesh:
    signed = [thing.name.split(NAMES_BETWEEN) for thing in of.facts.standing if thing.kind == STREET_NAME_SIGN]
    names = [name for sign in signed for name in sign]
    is_blade = of.boxes["tag"] == SemanticTag.TRAFFIC_SIGNS
    blades = PatchFrames(of.boxes["centre"][is_blade], of.boxes["yaw_rad"][is_blade])
    return join(
        [
            posts(of.frames, of.half_m(0), of.box(0)),
            blades_with_names(blades, of.boxes["half"][is_blade], of.every_box[is_blade], names),
        ]
    )


_MAKERS = {
    ObjectKind.TRAFFIC_LIGHT: _lights,
    ObjectKind.TRAFFIC_SIGN: _signs,
    ObjectKind.HOUSE: _houses,
    ObjectKind.TREE: _trees,
    ObjectKind.STREET_LAMP: _lamps,
    ObjectKind.WALL: _walls,
    ObjectKind.PORCH: _porches,
    ObjectKind.HEDGE: _hedges,
    ObjectKind.FENCE: _fences,
    ObjectKind.PARKED_CAR: _parked,
    ObjectKind.UTILITY_POLE: _poles,
    ObjectKind.SHELTER: _shelters,
    ObjectKind.BUILDING: _buildings,
    ObjectKind.BENCH: _benches,
    ObjectKind.BIN: _bins,
    ObjectKind.MAILBOX: _mailboxes,
    ObjectKind.STREET_NAME_SIGN: _name_signs,
}
