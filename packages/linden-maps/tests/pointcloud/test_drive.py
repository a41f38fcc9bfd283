"""Claims about the scans of a drive: where things are, in the map's frame, and that the lidar is the server's."""

import math

import numpy as np

from fakes.solids import box, described, floor, instances, look_at, seen_of
from linden.scenery.mesh import Mesh, join
from linden.sensors.casting.choose import caster_of
from linden.sensors.devices.lidar import SemanticLidar
from linden_maps.pointcloud.cloud import Cloud, in_map
from linden_maps.pointcloud.drive import Lidar, SensorPlace, drive

FEW = Lidar(channels=16, upper_fov_deg=5.0, lower_fov_deg=-40.0, range_m=60.0, columns=360)


def driven(standing: Mesh, *places: SensorPlace, lidar: Lidar = FEW) -> list[Cloud]:
    return [in_map(scan) for scan in drive(places, lidar, caster_of(standing, []), standing)]


def test_a_house_in_the_north_is_in_the_north_from_wherever_it_is_seen() -> None:
    # CARLA's y is south: this house stands 10 m north, 2 m high, and east of both places
    house = box((2.0, 1.0, 1.0), centre_m=(20.0, -10.0, 1.0), tag=3)
    for place in (SensorPlace(15.0, 0.0, 2.0, 0.0), SensorPlace(22.0, 3.0, 2.0, 2.0)):
        (cloud,) = driven(join([floor(), house]), place)
        assert cloud.label is not None
        wall = cloud.points_m[cloud.label == 3]
        assert len(wall) > 50
        assert (np.abs(wall - (20.0, 10.0, 1.0)) <= (2.001, 1.001, 1.001)).all()
        np.testing.assert_allclose(wall[:, 1].min(), 9.0, atol=1e-3)  # the side that faces south
        ground = cloud.points_m[cloud.label == 1]
        np.testing.assert_allclose(ground[:, 2], 0.0, atol=1e-3)


def test_a_scan_is_a_whole_turn_and_goes_no_farther_than_the_range() -> None:
    (cloud,) = driven(floor(), SensorPlace(0.0, 0.0, 2.0, 0.3))
    reach = np.linalg.norm(cloud.points_m - (0.0, 0.0, 2.0), axis=1)
    assert reach.max() <= 60.0 + 1e-3
    yaw = np.sort(np.arctan2(cloud.points_m[:, 1], cloud.points_m[:, 0]))
    assert np.diff(yaw).max() < math.radians(1.01)


def test_it_sees_what_the_servers_lidar_sees_there() -> None:
    standing = join(
        [floor(), box((2.0, 1.0, 1.0), centre_m=(9.0, -4.0, 1.0)), box((1.0, 6.0, 3.0), centre_m=(-8.0, 0.0, 3.0))]
    )
    place = SensorPlace(1.0, 2.0, 2.0, 0.7)
    sensor = SemanticLidar(
        described(
            "sensor.lidar.ray_cast_semantic",
            channels=16, upper_fov=5, lower_fov=-40, range=60, rotation_frequency=10, points_per_second=16 * 3600,
        )
    )  # fmt: skip
    theirs = sensor.measure(look_at(seen_of(standing, [], instances()), place.transform)).points["xyz"]
    (scan,) = drive([place], FEW, caster_of(standing, []), standing)
    np.testing.assert_allclose(scan.cloud.points_m * (1.0, -1.0, 1.0), theirs, atol=1e-4)


def test_points_that_are_not_finite_are_left_out() -> None:
    (scan,) = drive([SensorPlace(0.0, 0.0, 2.0, 0.0)], FEW, caster_of(floor(), []), floor())
    points = scan.cloud.points_m.copy()
    points[3, 1], points[5] = np.nan, np.inf
    cloud = in_map(scan._replace(cloud=Cloud(points, scan.cloud.label)))
    assert len(cloud.points_m) == len(points) - 2
    assert cloud.label is not None
    assert len(cloud.label) == len(points) - 2
    assert np.isfinite(cloud.points_m).all()


def test_a_pose_turns_before_it_moves() -> None:
    (scan,) = drive([SensorPlace(0.0, 0.0, 2.0, 0.0)], FEW, caster_of(floor(), []), floor())
    quarter = np.array([[0.0, -1.0, 0.0, 10.0], [1.0, 0.0, 0.0, 20.0], [0.0, 0.0, 1.0, 0.0]])
    moved = in_map(scan._replace(map_from_sensor=quarter)).points_m
    np.testing.assert_allclose(moved, scan.cloud.points_m[:, [1, 0, 2]] * (-1.0, 1.0, 1.0) + (10.0, 20.0, 0.0))
