"""Two upright boxes touch where their heights overlap and their ground rectangles share a point."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from shapely.affinity import rotate, translate
from shapely.geometry import box as rectangle

from linden.protocol.values.space import BoundingBox, Rotation, Transform, Vector3D
from linden.simulation.overlap import touching

sizes = st.floats(0.1, 5.0)
angles = st.floats(-180.0, 180.0)
near = st.floats(-8.0, 8.0)


def polygon(x, y, yaw_deg, half_x, half_y):
    return translate(rotate(rectangle(-half_x, -half_y, half_x, half_y), yaw_deg, origin=(0, 0)), x, y)


@given(near, near, angles, angles, sizes, sizes, sizes, sizes)
def test_the_plane_agrees_with_shapely(x, y, own_yaw, other_yaw, hx, hy, ox, oy) -> None:
    own = BoundingBox(Vector3D(), Vector3D(hx, hy, 1.0))
    pose = Transform(Vector3D(x, y, 0.0), Rotation(yaw=own_yaw))
    found = touching(
        own, pose, np.zeros((1, 3)), np.array([[ox, oy, 1.0]]), np.radians([other_yaw]), np.array([0])
    ).size
    gap_m = polygon(x, y, own_yaw, hx, hy).distance(polygon(0, 0, other_yaw, ox, oy))
    shared_m2 = polygon(x, y, own_yaw, hx, hy).intersection(polygon(0, 0, other_yaw, ox, oy)).area
    if gap_m > 1e-9 or shared_m2 > 1e-9:  # a bare touch may go either way in its last bit
        assert bool(found) == (gap_m == 0.0)


def test_one_above_the_other_do_not_touch() -> None:
    own = BoundingBox(Vector3D(0.0, 0.0, 0.8), Vector3D(2.0, 1.0, 0.8))
    columns = (np.array([[0.0, 0.0, 0.8]]), np.array([[2.0, 1.0, 0.8]]), np.zeros(1), np.array([0]))
    assert touching(own, Transform(Vector3D(0.0, 0.0, 1.5)), *columns).size == 1
    assert touching(own, Transform(Vector3D(0.0, 0.0, 1.7)), *columns).size == 0


def test_the_box_centre_turns_with_the_pose() -> None:
    own = BoundingBox(Vector3D(3.0, 0.0, 0.0), Vector3D(0.5, 0.5, 1.0))
    columns = (np.array([[0.0, 3.0, 0.0]]), np.array([[0.5, 0.5, 1.0]]), np.zeros(1), np.array([0]))
    assert touching(own, Transform(rotation=Rotation(yaw=90.0)), *columns).size == 1
    assert touching(own, Transform(rotation=Rotation(yaw=-90.0)), *columns).size == 0
