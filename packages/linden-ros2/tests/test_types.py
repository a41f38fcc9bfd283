"""Message types from their definitions."""

import numpy as np
import pytest

from linden_ros2.types import Generation, types_of


@pytest.mark.parametrize("generation", Generation)
def test_every_message_can_be_made_empty_written_and_read(generation: Generation) -> None:
    types = types_of(generation)
    failed = []
    for name in types.store.fielddefs:
        message = types.message(name)
        again = types.parsed(bytes(types.data(message)), name)
        if bytes(types.data(again)) != bytes(types.data(message)):
            failed.append(name)
    assert not failed
    assert len(types.store.fielddefs) > 150


def test_a_field_that_a_type_lacks_is_refused() -> None:
    with pytest.raises(TypeError, match="Header has no field seq"):
        types_of(Generation.ROS_2).message("std_msgs/msg/Header", seq=1)
    assert types_of(Generation.ROS_1).message("std_msgs/msg/Header", seq=1).seq == 1


def test_hashes_equal_the_hashes_that_ros_publishes() -> None:
    """MD5 sums as `rosmsg md5` prints them: std_msgs, nav_msgs and tf2_msgs of Noetic, and CARLA's control."""
    store = types_of(Generation.ROS_1).store
    sums = {name: store.generate_msgdef(name)[1] for name in SUMS}
    assert sums == SUMS


SUMS = {
    "std_msgs/msg/Header": "2176decaecbce78abc3b96ef049fabed",
    "nav_msgs/msg/Odometry": "cd5e73d190d741a2f92e81eda573aca7",
    "tf2_msgs/msg/TFMessage": "94810edda583a504dfda3829e70d7eec",
    "sensor_msgs/msg/PointCloud2": "1158d486dd51d683ce2f1be655c3c181",
    "rosgraph_msgs/msg/Clock": "a9c97c1d230cfc112e270351a944ee47",
    "ackermann_msgs/msg/AckermannDrive": "3512e91b48d69674a0e86fadf1ea8231",
}


def test_arrays_of_fixed_length_are_full_of_zeros() -> None:
    pose = types_of(Generation.ROS_2).message("geometry_msgs/msg/PoseWithCovariance")
    assert pose.covariance.shape == (36,)
    assert not np.any(pose.covariance)
