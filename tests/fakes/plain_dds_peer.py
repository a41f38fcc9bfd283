"""A peer on DDS that uses the wheel alone, with its own serialisation: prints what it hears, then commands.

Run as a process. The types come from the definitions; nothing of our nodes is used.
"""

import json
import sys

from cyclonedds.core import InstanceState, Policy, Qos, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from linden_ros2.dds_domain import ONLY_HERE
from linden_ros2.dds_node import node_list_types
from linden_ros2.dds_types import idl_structure
from linden_ros2.types import Generation, Types, types_of

TYPES = types_of(Generation.ROS_2)
LONGEST = duration(seconds=30)


def main(domain: int) -> None:
    local = Domain(domain, ONLY_HERE)
    participant = DomainParticipant(domain)
    volatile = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(10))
    latched = Qos(*volatile, Policy.Durability.TransientLocal)

    def listen(name: str, kind: str, qos: Qos, types: Types = TYPES) -> tuple[DataReader, ReadCondition]:
        reader = DataReader(participant, Topic(participant, name, idl_structure(types, kind)), qos)
        return reader, ReadCondition(reader, SampleState.NotRead | ViewState.Any | InstanceState.Alive)

    def next_of(heard: tuple[DataReader, ReadCondition]) -> object:
        reader, condition = heard
        waiting = WaitSet(participant)
        waiting.attach(condition)
        assert waiting.wait(LONGEST), "nothing came"
        return reader.take(N=1)[0]

    still = listen("rt/tf_static", "tf2_msgs/msg/TFMessage", latched)
    places = listen("rt/carla/hero/odometry", "nav_msgs/msg/Odometry", volatile)
    clouds = listen("rt/carla/hero/LIDAR", "sensor_msgs/msg/PointCloud2", volatile)
    nodes = listen("ros_discovery_info", "rmw_dds_common/msg/ParticipantEntitiesInfo", latched, node_list_types())
    control = idl_structure(TYPES, "carla_msgs/msg/CarlaEgoVehicleControl")
    commands = DataWriter(participant, Topic(participant, "rt/carla/hero/vehicle_control_cmd", control), volatile)
    tree, place, cloud, entry = (next_of(each) for each in (still, places, clouds, nodes))
    sys.stdout.write(
        json.dumps(
            {
                "frames": [each.child_frame_id for each in tree.transforms],
                "x": place.pose.pose.position.x,
                "y": place.pose.pose.position.y,
                "frame": place.header.frame_id,
                "points": cloud.width,
                "bytes": list(cloud.data[:8]),
                "fields": [each.name for each in cloud.fields],
                "nodes": [each.node_name for each in entry.node_entities_info_seq],
                "writers": max(len(each.writer_gid_seq) for each in entry.node_entities_info_seq),
            }
        )
        + "\n"
    )
    sys.stdout.flush()
    kinds = control.__annotations__
    header = kinds["header"](stamp=idl_structure(TYPES, "builtin_interfaces/msg/Time")(sec=3, nanosec=0), frame_id="")
    command = control(
        header=header, throttle=0.5, steer=-0.25, brake=0.0, hand_brake=False, reverse=True, gear=2,
        manual_gear_shift=True,
    )  # fmt: skip
    for line in sys.stdin:  # one command for each line, so that none is written before it is wanted
        if not line.strip():
            break
        commands.write(command)
    del local


if __name__ == "__main__":
    main(int(sys.argv[1]))
