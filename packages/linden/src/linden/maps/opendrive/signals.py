"""Signals as actors need them: their places, the lanes that they concern, the zones in which they take effect."""

from collections import defaultdict

from linden.background import checkpoint
from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.landmarks import landmark_transforms
from linden.maps.opendrive.limits import MOST_SIGNAL_LANES, MOST_SIGNAL_PLACES, refuse_beyond
from linden.maps.opendrive.links import LaneLinks, ends_of_roads, lane_links
from linden.maps.opendrive.model import NO_JUNCTION, OpenDrive, Road
from linden.maps.opendrive.roadside import Signal, SignalReference, Validity
from linden.maps.opendrive.signal_zones import LanePlace, trigger_boxes
from linden.maps.records import AffectedLane, PlacedSignal
from linden.protocol.values.enums import LaneType
from linden.protocol.values.space import Rotation, Transform

_MODEL_YAW_DEG = 90.0  # CARLA's light and sign models are turned by this against their signal


def place(opendrive: OpenDrive) -> tuple[PlacedSignal, ...]:
    """Return every signal of the map, in the order of the file."""
    tables, links = tables_of(opendrive), lane_links(opendrive)
    controllers = _controllers(opendrive)
    signals = list(opendrive.signals())
    _refuse_many_lanes(opendrive)
    spoken_to = {
        signal_id: [lane for reference in found for lane in _driving_lanes(tables, reference)]
        for signal_id, found in _references(opendrive).items()
    }
    refuse_beyond(
        sum(len(spoken_to[signal.id]) for _, signal in signals), MOST_SIGNAL_PLACES, "lanes that signals speak to"
    )
    places = [spoken_to[signal.id] for _, signal in signals]
    landmarks = landmark_transforms(opendrive)
    transforms = [
        Transform(landmark.location, Rotation(0.0, landmark.rotation.yaw + _MODEL_YAW_DEG, 0.0))
        for landmark in landmarks
    ]
    boxes = trigger_boxes(tables, links, transforms, places)
    junctions = _Junctions(opendrive, tables, links)
    placed = []
    for nth, (road, signal) in enumerate(signals):
        checkpoint()
        placed.append(
            PlacedSignal(
                signal_id=signal.id,
                type=signal.type,
                subtype=signal.subtype,
                value=signal.value,
                unit=signal.unit,
                name=signal.name,
                is_dynamic=signal.is_dynamic,
                is_light=signal.is_light,
                road_id=road.id,
                s_m=signal.s_m,
                landmark=landmarks[nth],
                transform=transforms[nth],
                controllers=tuple(controllers[signal.id]),
                junction_id=junctions.of_signal(road, controllers[signal.id], places[nth]),
                lanes=tuple(_affected(tables, lane) for lane in places[nth]),
                trigger_volumes=boxes[nth],
            )
        )
    return tuple(placed)


def _refuse_many_lanes(opendrive: OpenDrive) -> None:
    """Raise a MapError where signals or references to them ask for a look at very many lanes."""
    looks = 0
    for road in opendrive.roads:
        checkpoint()
        speaking: tuple[Signal | SignalReference, ...] = (*road.signals, *road.signal_references)
        for signal in speaking:
            looks += len(road.section_at(signal.s_m).lanes) * (1 + len(signal.validities))
    refuse_beyond(looks, MOST_SIGNAL_LANES, "lanes at the places of its signals and of references to them")


def _controllers(opendrive: OpenDrive) -> dict[str, list[str]]:
    """Map a signal's id to the controllers that switch it."""
    controllers: dict[str, list[str]] = defaultdict(list)
    for controller in opendrive.controllers:
        for signal_id in dict.fromkeys(controller.signals):
            controllers[signal_id].append(controller.id)
    return controllers


_Reference = tuple[int, float, tuple[Validity, ...]]


def _references(opendrive: OpenDrive) -> dict[str, list[_Reference]]:
    """Map a signal's id to the places it speaks at: (index of the road, s, lanes).

    A signal that stands before a junction and speaks to the lanes there has its line there. References to it on the
    connecting roads behind that line tell other programs which ways it governs, and make no second line.
    """
    references: dict[str, list[_Reference]] = defaultdict(list)
    stands_on: dict[str, Road] = {}
    for index, road in enumerate(opendrive.roads):
        for signal in road.signals:
            references[signal.id].append((index, signal.s_m, validities_of(road, signal)))
            if _speaks(road, signal):
                stands_on[signal.id] = road
    for index, road in enumerate(opendrive.roads):
        for reference in road.signal_references:
            before = stands_on.get(reference.signal_id)
            if before is None or before.is_in_junction or not _comes_from(road, before):
                references[reference.signal_id].append((index, reference.s_m, validities_of(road, reference)))
    return references


def _speaks(road: Road, signal: Signal) -> bool:
    """Return whether a signal speaks to a driving lane of the road that it stands on."""
    return any(
        lane.type is LaneType.DRIVING and lane.id != 0 and min(validity) <= lane.id <= max(validity)
        for lane in road.section_at(signal.s_m).lanes
        for validity in validities_of(road, signal)
    )


def _comes_from(road: Road, before: Road) -> bool:
    """Return whether a connecting road begins or ends at another road."""
    return road.is_in_junction and any(
        link is not None and (link.is_junction, link.id) == (False, before.id)
        for link in (road.predecessor, road.successor)
    )


def validities_of(road: Road, signal: Signal | SignalReference) -> tuple[Validity, ...]:
    """Return the lanes a signal speaks to; unless it says, LibCarla takes "+" for the left lanes, "-" for the right.

    Source: MapBuilder.cpp, GenerateDefaultValiditiesForSignalReferences; the usual reading of "+" is the opposite.
    """
    if signal.validities:
        return signal.validities
    lanes = [lane.id for lane in road.section_at(signal.s_m).lanes]
    left, right = Validity(1, max(lanes)), Validity(min(lanes), -1)
    sides = {"+": (left,), "-": (right,)}.get(signal.orientation, (left, right))
    return tuple(side for side in sides if side.from_lane <= side.to_lane)


def _driving_lanes(tables: Tables, reference: _Reference) -> list[LanePlace]:
    """Return the driving lanes that a reference names, from the left to the right."""
    road_index, s_m, validities = reference
    road = tables.roads[road_index]
    at_m = min(max(s_m, 0.0), road.length_m)
    section_index = road.section_index_at(at_m)
    return [
        LanePlace(tables.lane_row[road_index, section_index, lane.id], at_m)
        for lane in road.sections[section_index].lanes
        if lane.type is LaneType.DRIVING
        and lane.id != 0
        and any(min(validity) <= lane.id <= max(validity) for validity in validities)
    ]


def _affected(tables: Tables, place: LanePlace) -> AffectedLane:
    row = tables.lanes[place.lane]
    return AffectedLane(tables.roads[row["road"]].id, int(row["lane_id"]), place.s_m)


class _Junctions:
    """The junctions that signals belong to."""

    def __init__(self, opendrive: OpenDrive, tables: Tables, links: LaneLinks) -> None:
        self._tables, self._links, self._ends = tables, links, ends_of_roads(tables, links)
        self._of_controller = {
            controller: junction.id for junction in reversed(opendrive.junctions) for controller in junction.controllers
        }

    def of_signal(self, road: Road, controllers: list[str], places: list[LanePlace]) -> int:
        """Return the junction of the signal's controller or road, else the one its lanes lead into, -1 for none."""
        if controllers and controllers[0] in self._of_controller:
            return self._of_controller[controllers[0]]
        if road.is_in_junction:
            return road.junction_id
        for place in places:
            rows = self._links.successors[self._ends[place.lane]]
            ahead = self._tables.roads[self._tables.lanes["road"][rows[0]]] if rows else road
            if ahead.is_in_junction:
                return ahead.junction_id
        return NO_JUNCTION
