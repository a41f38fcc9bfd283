"""ROS software that drives `basu run ros` or `ros1` badly: each kind of failure after some good commands. A process."""

import sys

from basu.ros import dds, ros1
from basu.ros.topics import Message, control_of, odometry_of

GOOD = 5  # commands before the failure
LONGEST_S = 60.0


def main(kind: str, generation: str = "ros2") -> None:
    node = ros1.Node("stack") if generation == "ros1" else dds.Node("stack")
    seen, told = odometry_of("hero"), control_of("hero")
    node.listen(seen)
    node.announce(told)
    given = 0
    while node.wait(seen, LONGEST_S):
        for odometry in node.received(seen):
            given += 1
            if given > GOOD and kind == "dies":
                return
            if given > GOOD and kind == "stalls":
                continue
            throttle = float("nan") if given > GOOD and kind == "nan" else 0.5
            stamp = odometry.header.stamp
            header = node.types.message("std_msgs/msg/Header", stamp=stamp)
            node.publish(Message(told, node.types.message(told.type, header=header, throttle=throttle)))


if __name__ == "__main__":
    main(*sys.argv[1:])
