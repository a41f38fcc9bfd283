"""ROS software that drives badly: each kind of failure after some good commands. A process.

`KIND [GENERATION]` drives `basu run ros` or `ros1`; `seldom`, `seldom-stalls` and `localises` drive
`basu run autoware-ai`.
"""

import sys

from basu_ros import autoware_ai, dds, ros1
from basu_ros.topics import odometry_of
from linden_ros2.topic import CLOCK, Message, control_of

GOOD = 5  # commands before the failure
LONGEST_S = 60.0
FLOOD = 300  # commands for a frame
SELDOM_S = 0.35  # of simulated time, between two commands of a loop that misses turns
UNLOCALISED_S = 1.4  # of the clock, which begins at 1 s: before it a localisation has no map


def seldom(last: int, *, localises: bool) -> None:
    """Command an Autoware.AI's vehicle every so often by the simulated clock; ``last`` commands in all.

    One that ``localises`` has no pose before its first command, and ends where it gets another's.
    """
    node = ros1.Ros1Node("stack")
    types, due_s, given = node.types, UNLOCALISED_S if localises else 0.0, 0
    node.listen(CLOCK, autoware_ai.CURRENT_POSE)
    if localises:
        node.announce(autoware_ai.NDT_POSE)
    node.announce(autoware_ai.COMMAND)
    while node.wait(CLOCK, LONGEST_S):
        if localises and node.received(autoware_ai.CURRENT_POSE):
            return
        for clock in node.received(CLOCK):
            now_s = clock.clock.sec + 1e-9 * clock.clock.nanosec
            if now_s < due_s or given == last:
                continue
            due_s, given = now_s + SELDOM_S, given + 1
            header = types.message("std_msgs/msg/Header", stamp=clock.clock)
            twist = types.message("geometry_msgs/msg/Twist")
            twist.linear.x = 2.0
            stamped = types.message("geometry_msgs/msg/TwistStamped", twist=twist)
            node.publish(
                Message(autoware_ai.COMMAND, types.message(autoware_ai.COMMAND.type, header=header, twist_cmd=stamped))
            )


def main(kind: str, generation: str = "ros2") -> None:
    node = ros1.Ros1Node("stack") if generation == "ros1" else dds.Ros2Node("stack")
    seen, told = odometry_of("hero"), control_of("hero")
    node.listen(seen)
    node.announce(told)
    given, stamp = 0, None
    while node.wait(seen, LONGEST_S):
        for odometry in node.received(seen):
            given += 1
            if given > GOOD and kind == "dies":
                return
            if given > GOOD and kind == "stalls":
                continue
            throttle = float("nan") if given > GOOD and kind == "nan" else 0.5
            if kind != "stale" or given <= GOOD:
                stamp = odometry.header.stamp
            header = node.types.message("std_msgs/msg/Header", stamp=stamp)
            message = Message(told, node.types.message(told.type, header=header, throttle=throttle))
            for _ in range(FLOOD if kind == "floods" else 1):
                node.publish(message)


if __name__ == "__main__":
    if sys.argv[1].startswith(("seldom", "localises")):
        seldom(GOOD if sys.argv[1] == "seldom-stalls" else -1, localises=sys.argv[1] == "localises")
    else:
        main(*sys.argv[1:])
