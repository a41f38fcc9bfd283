"""ROS 2 software that drives `basu run ros` badly: each kind of failure after some good commands. Run as a process."""

import sys

from basu.ros.dds import Node
from basu.ros.topics import Message, control_of, odometry_of

GOOD = 5  # commands before the failure
LONGEST_S = 60.0


def main(kind: str) -> None:
    node = Node("stack")
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
