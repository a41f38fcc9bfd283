"""Which trigger volume a vehicle touches, against polygons laid over each other."""

import math

import numpy as np
import pytest
from shapely import affinity
from shapely.geometry import Polygon, box

from linden.protocol.values.space import BoundingBox, Rotation, Vector3D
from linden.traffic.trigger_volumes import owners_over, trigger_grid


def outline(x: float, y: float, half_x: float, half_y: float, yaw_deg: float) -> Polygon:
    turned = affinity.rotate(box(-half_x, -half_y, half_x, half_y), yaw_deg, origin=(0, 0))
    return affinity.translate(turned, x, y)


def volume(x: float, y: float, yaw_deg: float = 0.0, z: float = 0.0, half_x: float = 1.5) -> BoundingBox:
    return BoundingBox(Vector3D(x, y, z), Vector3D(half_x, 0.9, 1.0), Rotation(0.0, yaw_deg, 0.0))


class Bodies:
    """Columns of ``count`` cars of 4.6 m by 2 m, the box a little ahead of the origin."""

    def __init__(self, count: int) -> None:
        self.position = np.zeros((count, 3))
        self.rotation = np.zeros((count, 3))
        self.box_centre = np.tile([0.3, 0.0, 0.75], (count, 1))
        self.half_extent = np.tile([2.3, 1.0, 0.75], (count, 1))

    def over(self, volumes: list[tuple[int, BoundingBox]], slots: list[int] | None = None) -> list[int]:
        chosen = np.arange(len(self.position)) if slots is None else np.array(slots)
        columns = (self.position, self.rotation, self.box_centre, self.half_extent)
        return owners_over(trigger_grid(volumes), *columns, chosen.astype(np.int32)).tolist()


def test_a_bumper_is_enough() -> None:
    bodies = Bodies(3)
    bodies.position[:, 0] = [-2.5, -4.0, -4.2]  # the front is 2.6 m ahead of the origin, the volume begins at -1.5
    assert bodies.over([(7, volume(0.0, 0.0))]) == [7, 7, -1]


def test_a_volume_on_a_bridge_is_not_touched_from_below() -> None:
    bodies = Bodies(2)
    bodies.position[1, 2] = 6.0
    assert bodies.over([(0, volume(0.0, 0.0, z=6.0))]) == [-1, 0]


def test_of_two_volumes_the_nearer_one_counts() -> None:
    bodies = Bodies(1)
    assert bodies.over([(0, volume(-1.6, 0.0)), (1, volume(1.5, 0.0)), (2, volume(2.4, 0.0))]) == [1]


def test_only_the_slots_asked_for_are_answered_in_their_order() -> None:
    bodies = Bodies(4)
    bodies.position[:, 0] = [0.0, 500.0, 1000.0, 1500.0]
    volumes = [(index, volume(500.0 * index, 0.0)) for index in range(4)]
    assert bodies.over(volumes, [3, 1]) == [3, 1]


def test_where_there_is_no_volume_no_vehicle_is_under_one() -> None:
    assert Bodies(2).over([]) == [-1, -1]


@pytest.mark.parametrize("far", [1e3, 1e6, -1e6])
def test_beyond_the_grid_there_is_nothing(far: float) -> None:
    bodies = Bodies(2)
    bodies.position[0, 0] = far
    bodies.position[1, 1] = far
    assert bodies.over([(0, volume(0.0, 0.0)), (1, volume(300.0, 40.0))]) == [-1, -1]


def test_a_place_that_is_no_number_is_under_nothing() -> None:
    bodies = Bodies(3)
    bodies.position[0], bodies.position[1, 0], bodies.position[2, 1] = math.nan, math.nan, math.nan
    assert bodies.over([(0, volume(0.0, 0.0)), (1, volume(50.0, 0.0))]) == [-1, -1, -1]


@pytest.mark.parametrize("size_m", [40.0, 400.0, 30_000.0])
def test_the_grid_finds_what_trying_every_volume_finds(size_m: float) -> None:
    random = np.random.default_rng(20)
    volumes = [
        (
            owner,
            volume(*random.uniform(0, size_m, 2), yaw_deg=random.uniform(-180, 180), half_x=random.uniform(1, 6)),
        )
        for owner in range(40)
    ]
    bodies = Bodies(400)
    near = np.array([volumes[i % 40][1].location for i in range(400)])
    bodies.position[:] = near + np.column_stack([random.uniform(-6, 6, (400, 2)), np.zeros(400)])
    bodies.rotation[:, 1] = random.uniform(-math.pi, math.pi, 400)
    found = bodies.over(volumes)
    shapes = [outline(v.location.x, v.location.y, v.extent.x, v.extent.y, v.rotation.yaw) for _, v in volumes]
    touched = 0
    for body in range(400):
        yaw = bodies.rotation[body, 1]
        centre = bodies.position[body, :2] + 0.3 * np.array([math.cos(yaw), math.sin(yaw)])
        car = outline(*centre, 2.3, 1.0, math.degrees(yaw))
        under = [owner for owner, shape in enumerate(shapes) if shape.intersects(car)]
        if not under:
            assert found[body] == -1
            continue
        touched += 1
        distances = [math.dist(centre, volumes[owner][1].location[:2]) for owner in under]
        assert found[body] == under[int(np.argmin(distances))]
    assert 100 < touched < 400
