"""Tests of ``basu.managers.observations``."""

import math
from types import SimpleNamespace
from typing import Any

import carla
import pytest

from basu.managers.base_manager import Ego, Frame
from basu.managers.observations import SMALLEST_M, LaneFinder, LaneUnder, Neighbours, RouteLights, lane_under
from basu.records.history.model import NO_LIGHT
from fakes.crossing_map import LANE_M, crossing
from fakes.drives import stop_sign, straight_route, traffic_light

DRIVING = int(carla.LaneType.Driving)


@pytest.fixture(scope="module")
def town() -> carla.Map:
    return carla.Map("Crossing", crossing())


def at(town: carla.Map, x_m: float, y_m: float, yaw_rad: float = 0.0) -> LaneUnder:
    return lane_under(town, Ego(x_m, y_m, 0.0, 0.0, 0.0, yaw_rad, *[0.0] * 9))


def test_in_the_lane_to_the_east_one_stands_as_it_goes(town: carla.Map) -> None:
    lane = at(town, 40.0, LANE_M / 2.0 + 0.5)
    assert lane.lane_type == DRIVING
    assert lane.lane_offset_m == pytest.approx(0.5, abs=1e-3)
    assert lane.lane_heading_rad == pytest.approx(0.0, abs=1e-6)
    assert lane.lane_width_m == pytest.approx(LANE_M)
    assert not lane.in_junction
    assert lane.off_lane_m == 0.0


def test_across_the_middle_one_stands_against_the_lane(town: carla.Map) -> None:
    lane = at(town, 40.0, -LANE_M / 2.0 - 0.5)
    assert abs(lane.lane_heading_rad) == pytest.approx(math.pi, abs=1e-6)
    assert lane.lane_offset_m == pytest.approx(0.5, abs=1e-3)  # to the right of a lane that goes west


def test_in_the_middle_of_the_crossing_one_is_in_a_junction(town: carla.Map) -> None:
    assert at(town, 0.0, 1.0).in_junction


@pytest.mark.parametrize("beyond_m", [0.2, 1.5, 12.0])
def test_beside_the_road_there_is_no_lane_but_a_distance_to_its_edge(town: carla.Map, beyond_m: float) -> None:
    lane = at(town, 50.0, LANE_M + beyond_m)
    assert (lane.road_id, lane.lane_id, lane.lane_type) == (0, 0, 0)
    assert math.isnan(lane.lane_offset_m)
    assert lane.off_lane_m == pytest.approx(beyond_m, abs=1e-3)


def test_that_stands_still_is_not_looked_for_again(town: carla.Map) -> None:
    asked = []

    class Map:
        def get_waypoint(self, place: Any, **options: Any) -> Any:
            asked.append(place)
            return town.get_waypoint(place, **options)

    finder, there = LaneFinder(Map()), Ego(5.0, 1.0, 0.0, 0.0, 0.0, 0.0, *[0.0] * 9)
    first = finder.under(there)
    count = len(asked)
    assert finder.under(there) is first
    assert len(asked) == count
    assert finder.under(there._replace(y_m=1.5)).lane_offset_m != first.lane_offset_m


RED, GREEN = 0, 2


class World:
    """Knows two lights by their signals' ids."""

    def get_traffic_light_from_opendrive_id(self, landmark_id: str) -> SimpleNamespace | None:
        state = {"12": RED, "13": GREEN}.get(landmark_id)
        return None if state is None else SimpleNamespace(get_state=lambda: state)


LIGHTS = RouteLights(
    World(),
    straight_route(
        controls=(stop_sign(10.0), traffic_light(50.0, "12"), traffic_light(60.0, "99"), traffic_light(90.0, "13"))
    ),
    2.0,
)


@pytest.mark.parametrize(
    ("s_m", "state"), [(0.0, RED), (52.9, RED), (53.1, GREEN), (93.1, NO_LIGHT)], ids=["ahead", "under", "past", "last"]
)
def test_a_light_counts_until_its_line_is_a_metre_behind_the_rear(s_m: float, state: int) -> None:
    assert LIGHTS.next_state(s_m) == state


def test_a_signal_that_the_simulator_has_no_light_for_is_passed_over() -> None:
    assert LIGHTS.next_state(55.0) == GREEN


EGO = Ego(*[0.0] * 15)


def actor(key: int, type_id: str, x_m: float, *, z_m: float = 0.0, yaw_deg: float = 0.0, box: Any = None) -> Any:
    box = box or carla.BoundingBox(carla.Location(0.0, 0.0, 0.5), carla.Vector3D(1.0, 0.5, 0.5))
    pose = carla.Transform(carla.Location(x_m, 0.0, z_m), carla.Rotation(yaw=yaw_deg))
    return SimpleNamespace(
        id=key,
        type_id=type_id,
        bounding_box=box,
        get_transform=lambda: pose,
        get_velocity=carla.Vector3D,
        get_angular_velocity=carla.Vector3D,
    )


class Snapshot(dict[int, Any]):
    timestamp = SimpleNamespace(elapsed_seconds=0.0)

    def find(self, key: int) -> Any:
        return self.get(key)


def near(*actors: Any) -> tuple[list[int], Neighbours]:
    """The ids of the rows for actors around an ego at the origin."""
    found = Neighbours(SimpleNamespace(get_actors=lambda: list(actors)), ego_id=1)
    frame: Any = Frame(0, 7, Snapshot({one.id: one for one in actors}), EGO)  # type: ignore[arg-type]
    return [int(row[1]) for row in found.near(frame)], found


def test_things_are_recorded_behind_vehicles_and_walkers_with_their_sizes() -> None:
    ids, found = near(
        actor(2, "static.prop.streetsign04", 5.0),
        actor(3, "walker.pedestrian.0001", 20.0),
        actor(4, "vehicle.audi.tt", 10.0),
    )
    assert ids == [4, 3, 2]
    assert found.met[2] == "static.prop.streetsign04"
    assert found.sizes[2] == (1.0, 0.5)


@pytest.mark.parametrize(
    "type_id", ["sensor.camera.rgb", "traffic.stop", "spectator", "static.trigger.friction", "controller.ai.walker"]
)
def test_what_stands_in_nobodys_way_is_not(type_id: str) -> None:
    assert near(actor(2, type_id, 5.0))[0] == []


def test_a_thing_that_hangs_overhead_is_not_until_it_comes_down() -> None:
    assert near(actor(2, "static.prop.streetsign04", 5.0, z_m=4.0))[0] == []
    assert near(actor(2, "static.prop.streetsign04", 5.0, z_m=1.0))[0] == [2]


def test_things_do_not_crowd_out_vehicles() -> None:
    props = [actor(10 + n, "static.prop.trafficcone01", 1.0 + 0.1 * n) for n in range(40)]
    assert 2 in near(actor(2, "vehicle.audi.tt", 50.0), *props)[0]


def test_the_place_is_that_of_the_boxs_middle() -> None:
    box = carla.BoundingBox(carla.Location(0.5, 0.0, 0.5), carla.Vector3D(1.0, 0.5, 0.5))
    found = Neighbours(SimpleNamespace(get_actors=lambda: [one]), ego_id=1)
    one = actor(2, "vehicle.audi.tt", 10.0, yaw_deg=90.0, box=box)
    frame: Any = Frame(0, 7, Snapshot({2: one}), EGO)  # type: ignore[arg-type]
    assert found.near(frame)[0][2:4] == pytest.approx((10.0, 0.5), abs=1e-6)


def test_an_empty_box_gets_a_size() -> None:
    box = carla.BoundingBox(carla.Location(), carla.Vector3D())
    assert near(actor(2, "static.prop.mesh", 5.0, box=box))[1].sizes[2] == (SMALLEST_M, SMALLEST_M)
