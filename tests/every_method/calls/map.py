"""The client's own reading of the OpenDRIVE text: waypoints, junctions, landmarks, road marks."""

from typing import Any

import carla
import pytest

from every_method.call import Call
from every_method.entries import fields
from every_method.stage import Stage
from opendrive_texts import street_through_junction

ROAD_MARK = (
    '<object id="7" name="Stencil_STOP" type="-1" s="20" t="-1.75" zOffset="0.01" hdg="0" pitch="0" roll="0" '
    'orientation="-" width="2" length="3" validLength="0"/>'
)


def marked(_: Stage) -> carla.Map:
    """A street with a word painted on it, which Linden's streets do not have."""
    return carla.Map("Marked", street_through_junction(objects=ROAD_MARK))


def road_mark(stage: Stage) -> Any:
    """The word."""
    return marked(stage).get_all_road_marks()[0]


def straight(stage: Stage) -> carla.Waypoint:
    """A place with 10 m of lane before and behind, out of any junction."""
    return next(
        found
        for found in stage.map.generate_waypoints(20.0)
        if not found.is_junction
        and len(found.next(10.0)) == len(found.previous(10.0)) == 1
        and not found.next(10.0)[0].is_junction
        and not found.previous(10.0)[0].is_junction
        and min(len(found.next_until_lane_end(1.0)), len(found.previous_until_lane_start(1.0))) >= 10
    )


def in_junction(stage: Stage) -> carla.Waypoint:
    """A place in a junction."""
    return next(found for found in stage.map.generate_waypoints(5.0) if found.is_junction)


def stop_sign(stage: Stage) -> carla.Landmark:
    """One of the map's stop signs, as a lane sees it."""
    signs = stage.map.get_all_landmarks_of_type("206")
    for sign in signs:
        (first, *_) = sign.get_lane_validities()
        before = stage.map.get_waypoint_xodr(sign.road_id, first[0] or first[1], max(sign.s - 5.0, 1.0))
        after = stage.map.get_waypoint_xodr(sign.road_id, first[0] or first[1], sign.s + 5.0)
        for place in (before, after):
            seen = [found for found in place.get_landmarks(30.0) if found.id == sign.id] if place else []
            if seen:
                return seen[0]
    raise AssertionError("no stop sign is seen by its lane")


def comes_back(stage: Stage) -> bool:
    """Whether a place turned into latitude and longitude is turned back."""
    place = carla.Location(120.0, -80.0, 3.0)
    back = stage.map.geolocation_to_transform(stage.map.transform_to_geolocation(place))
    return bool((back.x, back.y, back.z) == pytest.approx((120.0, -80.0, 3.0), abs=0.05))


def written(stage: Stage) -> bool:
    """Whether the text is written to disk."""
    path = stage.folder / "written"
    stage.map.save_to_disk(str(path))
    return path.with_suffix(".xodr").stat().st_size > 1000


def cooked(stage: Stage) -> bool:
    """Whether the Traffic Manager's graph of a small map is written to disk."""
    path = stage.folder / "graph.bin"
    marked(stage).cook_in_memory_map(str(path))
    return path.stat().st_size > 0


def yields_text(member: str, make: Any) -> dict[str, Call]:
    """Return the row of ``str``."""
    return {f"{member}.__str__": lambda stage: len(str(make(stage))) > 0}


CALLS: dict[str, Call] = {
    "Map.__init__": lambda _: carla.Map("Marked", street_through_junction()).name == "Marked",
    "Map.name": lambda s: s.map.name == "Carla/Maps/Linden",
    "Map.__str__": lambda s: "Linden" in str(s.map),
    "Map.cook_in_memory_map": cooked,
    "Map.generate_waypoints": lambda s: len(s.map.generate_waypoints(50.0)) > 100,
    "Map.save_to_disk": written,
    "Map.to_opendrive": lambda s: "<OpenDRIVE" in s.map.to_opendrive(),
    "Map.transform_to_geolocation": lambda s: abs(s.map.transform_to_geolocation(carla.Location()).latitude) <= 90.0,
    "Map.geolocation_to_transform": comes_back,
    "Map.get_all_landmarks": lambda s: len(s.map.get_all_landmarks()) > 100,
    "Map.get_all_landmarks_from_id": lambda s: (
        [found.id for found in s.map.get_all_landmarks_from_id(stop_sign(s).id)] == [stop_sign(s).id]
    ),
    "Map.get_all_landmarks_of_type": lambda s: (
        {found.type for found in s.map.get_all_landmarks_of_type("206")} == {"206"}
    ),
    "Map.get_landmark_group": lambda s: isinstance(s.map.get_landmark_group(stop_sign(s)), list),
    "Map.get_crosswalks": lambda s: len(s.map.get_crosswalks()) >= 5,
    "Map.get_spawn_points": lambda s: len(s.map.get_spawn_points()) > 10,
    "Map.get_topology": lambda s: all(len(pair) == 2 for pair in s.map.get_topology()),
    "Map.get_waypoint": lambda s: s.map.get_waypoint(s.waypoint.transform.location).road_id == s.waypoint.road_id,
    "Map.get_waypoint_xodr": lambda s: (
        s.map.get_waypoint_xodr(s.waypoint.road_id, s.waypoint.lane_id, s.waypoint.s).id == s.waypoint.id
    ),
    "Map.get_all_road_marks": lambda s: len(marked(s).get_all_road_marks()) == 1,
    "Map.get_all_road_marks_of_type": lambda s: len(marked(s).get_all_road_marks_of_type(road_mark(s).type)) == 1,
    "Map.get_road_marks_from_id": lambda s: len(marked(s).get_road_marks_from_id("7")) == 1,
    **fields(
        "Waypoint",
        straight,
        id=lambda number: number >= 0,
        transform=lambda pose: isinstance(pose, carla.Transform),
        road_id=lambda number: number >= 0,
        section_id=lambda number: number >= 0,
        is_junction=False,
        is_intersection=False,
        junction_id=-1,
        lane_id=lambda lane: lane != 0,
        s=lambda at_m: at_m >= 0.0,
        lane_width=lambda wide_m: 2.0 < wide_m < 6.0,
        lane_change=lambda kind: isinstance(kind, carla.LaneChange),
        lane_type=carla.LaneType.Driving,
        right_lane_marking=lambda mark: mark.width >= 0.0,
        left_lane_marking=lambda mark: mark.width >= 0.0,
        is_rht=True,
    ),
    **yields_text("Waypoint", straight),
    "Waypoint.next": lambda s: (
        straight(s).next(10.0)[0].transform.location.distance(straight(s).transform.location)
        == pytest.approx(10.0, abs=0.5)
    ),
    "Waypoint.previous": lambda s: straight(s).previous(10.0)[0].s != straight(s).s,
    "Waypoint.next_until_lane_end": lambda s: len(straight(s).next_until_lane_end(1.0)) >= 10,
    "Waypoint.previous_until_lane_start": lambda s: len(straight(s).previous_until_lane_start(1.0)) >= 10,
    "Waypoint.get_junction": lambda s: in_junction(s).get_junction().id == in_junction(s).junction_id,
    "Waypoint.get_landmarks": lambda s: stop_sign(s).distance <= 30.0,
    "Waypoint.get_landmarks_of_type": lambda s: (
        {found.type for found in stop_sign(s).waypoint.previous(3.0)[0].get_landmarks_of_type(30.0, "206")} == {"206"}
    ),
    "Waypoint.get_left_lane": lambda s: straight(s).get_left_lane().lane_id != straight(s).lane_id,
    "Waypoint.get_right_lane": lambda s: straight(s).get_right_lane().lane_type != carla.LaneType.Driving,
    **fields(
        "Junction",
        lambda s: in_junction(s).get_junction(),
        id=lambda number: number >= 0,
        bounding_box=lambda box: box.extent.x > 1.0,
    ),
    "Junction.get_waypoints": lambda s: len(in_junction(s).get_junction().get_waypoints(carla.LaneType.Driving)) > 0,
    **fields(
        "LaneMarking",
        lambda s: straight(s).left_lane_marking,
        color=lambda colour: isinstance(colour, carla.LaneMarkingColor),
        lane_change=lambda change: isinstance(change, carla.LaneChange),
        type=lambda kind: isinstance(kind, carla.LaneMarkingType),
        width=lambda wide_m: 0.0 <= wide_m < 1.0,
    ),
    **fields(
        "Landmark",
        stop_sign,
        road_id=lambda number: number >= 0,
        distance=lambda far_m: 0.0 <= far_m <= 30.0,
        s=lambda at_m: at_m >= 0.0,
        t=lambda at_m: abs(at_m) < 20.0,
        id=lambda text: len(text) > 0,
        name=lambda text: isinstance(text, str),
        is_dynamic=False,
        type="206",
        orientation=lambda way: isinstance(way, carla.LandmarkOrientation),
        z_offset=lambda up_m: -1.0 < up_m < 6.0,
        country=lambda text: isinstance(text, str),
        sub_type=lambda text: isinstance(text, str),
        value=lambda number: isinstance(number, float),
        unit=lambda text: isinstance(text, str),
        height=lambda high_m: 0.0 <= high_m < 3.0,
        width=lambda wide_m: 0.0 <= wide_m < 3.0,
        text=lambda text: isinstance(text, str),
        h_offset=lambda rad: abs(rad) < 7.0,
        pitch=0.0,
        roll=0.0,
        waypoint=lambda place: isinstance(place, carla.Waypoint),
        transform=lambda pose: isinstance(pose, carla.Transform),
    ),
    "Landmark.get_lane_validities": lambda s: all(len(lanes) == 2 for lanes in stop_sign(s).get_lane_validities()),
    **fields(
        "RoadMark",
        road_mark,
        id="7",
        name="Stencil_STOP",
        road_id=1,
        s=20.0,
        t=-1.75,
        z_offset=0.01,
        heading=0.0,
        pitch=0.0,
        roll=0.0,
        width=2.0,
        length=3.0,
        distance=0.0,
        type=lambda text: isinstance(text, str),
        orientation=carla.RoadMarkOrientation.Negative,
        transform=lambda pose: isinstance(pose, carla.Transform),
        waypoint=lambda place: place is None or isinstance(place, carla.Waypoint),
    ),
}
