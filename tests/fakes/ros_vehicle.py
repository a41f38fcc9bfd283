"""A vehicle with a lidar for tests of ROS nodes, and a moment of it."""

from types import SimpleNamespace as Fake

import numpy as np

from basu_ros.moment import Control, Measurement, Moment, Motion, Vehicle
from linden_ros2.mount import Mount
from linden_ros2.topic import Topic

LIDAR = Mount("LIDAR", "sensor.lidar.ray_cast", 0.0, 0.0, 2.4)
VEHICLE = Vehicle("hero", [LIDAR])
CLOUD = Topic("/carla/hero/LIDAR", "sensor_msgs/msg/PointCloud2")


def moment(points: int) -> Moment:
    """A moment in which the lidar has measured so many points."""
    rows = np.arange(4 * points, dtype=np.float32)
    motion = Motion(12.5, 7.0, *([0.0] * 13))
    return Moment(1.0, 20, motion, Control(), measured=[Measurement(LIDAR, Fake(raw_data=rows.tobytes()))])
