"""The obstacle detector's ball before walls, edges and posts."""

import math

import numpy as np
import pytest

from fakes.solids import at, box, described, floor, instances, look_at, seen_of
from linden.protocol.values.enums import SemanticTag
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.scenery.mesh import join
from linden.sensors.devices.obstacle import Obstacle, ObstacleDetector

LEVEL = Transform(Vector3D(0.0, 0.0, 1.0))


def found(seen, pose: Transform = LEVEL, *, carrier_id: int = 0, **chosen: object) -> Obstacle | None:
    detector = ObstacleDetector(described("sensor.other.obstacle", **{"distance": 20, **chosen}))
    return detector.measure(look_at(seen, pose, carrier_id=carrier_id))


def wall(x_m: float):
    return box((0.5, 30.0, 30.0), centre_m=(x_m + 0.5, 0.0, 0.0), tag=SemanticTag.WALLS)


def test_the_ball_stops_where_it_touches_the_wall() -> None:
    obstacle = found(seen_of(wall(8.0), [], instances()), hit_radius=0.5)
    assert obstacle == (0, SemanticTag.WALLS, pytest.approx(7.5, abs=1e-3))


def test_before_a_wall_across_its_way_it_stops_sooner() -> None:
    slanted = Transform(Vector3D(0.0, 0.0, 1.0), Rotation(yaw=40.0))
    obstacle = found(seen_of(wall(8.0), [], instances()), slanted, hit_radius=0.5)
    assert obstacle is not None
    assert obstacle.distance_m == pytest.approx((8.0 - 0.5) / math.cos(math.radians(40.0)), abs=0.01)


def test_an_edge_beside_the_way_stops_it_late_and_one_further_off_not_at_all() -> None:
    def beside(gap_m: float) -> Obstacle | None:
        post = box((0.1, 0.1, 5.0), centre_m=(10.1, gap_m + 0.1, 0.0))
        return found(seen_of(post, [], instances()), hit_radius=0.5)

    obstacle = beside(0.4)
    assert obstacle is not None
    assert obstacle.distance_m == pytest.approx(10.0 - 0.3, abs=0.05)  # sqrt(0.5² - 0.4²)
    assert beside(0.52) is None


def test_its_distance_ends_it() -> None:
    seen = seen_of(wall(8.0), [], instances())
    assert found(seen, distance=7.4, hit_radius=0.5) is None
    assert found(seen, distance=7.6, hit_radius=0.5) is not None


def test_its_carrier_is_looked_through_and_the_next_actor_is_named() -> None:
    moving = instances((0, 3, at(0.0, 0.0, 1.0)), (0, 4, at(10.0, 0.0, 1.0)))
    seen = seen_of(join([floor(), wall(15.0)]), [box((2.0, 1.0, 0.9), tag=SemanticTag.CAR)], moving)
    obstacle = found(seen, carrier_id=3, hit_radius=0.3)
    assert obstacle == (4, SemanticTag.CAR, pytest.approx(7.7, abs=1e-3))
    assert found(seen, hit_radius=0.3)[0] == 3


def test_only_dynamics_looks_through_all_that_stands() -> None:
    moving = instances((0, 4, at(10.0, 0.0, 1.0)))
    seen = seen_of(join([floor(), wall(5.0)]), [box((2.0, 1.0, 0.9))], moving)
    assert found(seen, hit_radius=0.3)[0] == 0
    assert found(seen, hit_radius=0.3, only_dynamics="true") == (4, 3, pytest.approx(7.7, abs=1e-3))
    nobody = seen_of(wall(5.0), [], instances())
    assert found(nobody, only_dynamics="true") is None


def test_a_ball_that_lies_on_the_road_hits_the_road() -> None:
    low = Transform(Vector3D(0.0, 0.0, 0.3))
    road = seen_of(floor(tag=SemanticTag.ROADS), [], instances())
    assert found(road, low, hit_radius=0.5) == (0, SemanticTag.ROADS, 0.0)
    assert found(road, low, hit_radius=0.29) is None
    downhill = Transform(Vector3D(0.0, 0.0, 1.0), Rotation(pitch=-10.0))
    obstacle = found(road, downhill, hit_radius=0.5)
    assert obstacle is not None
    assert obstacle.tag == SemanticTag.ROADS
    assert obstacle.distance_m == pytest.approx(0.5 / math.sin(math.radians(10.0)), abs=0.05)


def test_traffic_lights_and_signs_are_actors_though_they_stand() -> None:
    post = box((0.1, 0.1, 5.0), centre_m=(10.1, 0.0, 0.0), tag=SemanticTag.POLES, thing=1)
    seen = seen_of(post, [], instances(), object_id=(0x8000_8000, 42))
    assert found(seen, hit_radius=0.5)[:2] == (42, SemanticTag.POLES)


def test_without_a_radius_it_is_one_ray() -> None:
    seen = seen_of(wall(8.0), [], instances())
    assert found(seen, hit_radius=0)[2] == pytest.approx(8.0, abs=1e-4)
    assert np.isfinite(found(seen, hit_radius=0)[2])
