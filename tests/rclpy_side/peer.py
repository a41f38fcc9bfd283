"""Nodes of real rclpy, in its environment: `peer.py hear`, `peer.py drive KIND`, `peer.py publish TOPIC TYPE`,
`peer.py count TOPIC TYPE NUMBER`, `peer.py command KIND`, `peer.py call`, `peer.py weather`.

`hear` reads a JSON list of topics from its standard input and prints what it heard as soon as every topic has spoken.
`call` reads requests, each a JSON list of a service's name, its type and its fields, and prints each answer or null.
"""

import importlib
import json
import sys
import time

import rclpy
from diagnostic_msgs.msg import KeyValue
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import serialize_message

LONGEST_S = 40.0
GOOD = 5  # commands before the one that fails


def class_of(name: str) -> type:
    package, _, message = name.split("/")
    return getattr(importlib.import_module(f"{package}.msg"), message)


def profile(*, is_latched: bool = False, is_reliable: bool = True) -> QoSProfile:
    return QoSProfile(
        depth=10,
        reliability=ReliabilityPolicy.RELIABLE if is_reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if is_latched else DurabilityPolicy.VOLATILE,
    )


def hear() -> None:
    """Listen to every topic, and print each first message with what the graph says of its publisher."""
    node, heard = Node("listener"), {}
    wanted = json.loads(sys.stdin.readline())
    for name, kind, is_latched, is_reliable in wanted:
        qos = profile(is_latched=is_latched, is_reliable=is_reliable)
        node.create_subscription(class_of(kind), name, lambda each, name=name: heard.setdefault(name, each), qos)
    until_s = node.get_clock().now().nanoseconds * 1e-9 + LONGEST_S
    while not (len(heard) == len(wanted) and names(node)) and node.get_clock().now().nanoseconds * 1e-9 < until_s:
        rclpy.spin_once(node, timeout_sec=0.1)
    sys.stdout.write(json.dumps([described(node, name, each) for name, each in heard.items()]) + "\n")
    sys.stdout.flush()


def names(node: Node) -> list[str]:
    """The other nodes."""
    return [name for name in node.get_node_names() if name != node.get_name()]


def described(node: Node, name: str, message: object) -> dict[str, object]:
    """A message and its publisher."""
    header = getattr(message, "header", None)
    [publisher] = node.get_publishers_info_by_topic(name)
    return {
        "topic": name,
        "bytes": serialize_message(message).hex(),
        "frame": None if header is None else header.frame_id,
        "stamp": None if header is None else [header.stamp.sec, header.stamp.nanosec],
        "nodes": names(node),
        "type": publisher.topic_type,
        "hash": str(publisher.topic_type_hash),
        "latched": publisher.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL,
        "reliable": publisher.qos_profile.reliability == ReliabilityPolicy.RELIABLE,
    }


def drive(kind: str) -> None:
    """Answer each odometry with a command until the run is over, or publish commands that cannot be heard."""
    command_type = class_of("carla_msgs/msg/CarlaEgoVehicleControl")
    node, given = Node("driver"), []
    reliability = {"best-effort": False}.get(kind, True)
    publisher = node.create_publisher(command_type, "/carla/hero/vehicle_control_cmd", profile(is_reliable=reliability))

    def answer(odometry: Odometry) -> None:
        command = command_type(throttle=0.5)
        command.header.stamp = odometry.header.stamp
        given.append(command)
        if kind == "dies" and len(given) > GOOD:
            raise SystemExit
        publisher.publish(command)

    node.create_subscription(Odometry, "/carla/hero/odometry", answer, profile())
    rclpy.spin(node)


def publish(name: str, kind: str) -> None:
    """Publish an empty message again and again."""
    node = Node("talker")
    publisher = node.create_publisher(class_of(kind), name, profile())
    node.create_timer(0.05, lambda: publisher.publish(class_of(kind)()))
    rclpy.spin(node)


def count(name: str, kind: str, number: str) -> None:
    """Print the stamps in s of so many messages in a row, each with the frame of its header."""
    node, heard = Node("counter"), []

    def note(message: object) -> None:
        stamp = message.clock if hasattr(message, "clock") else message.header.stamp
        heard.append(stamp.sec + 1e-9 * stamp.nanosec)

    node.create_subscription(class_of(kind), name, note, profile())
    until_s = time.monotonic() + LONGEST_S
    while len(heard) < int(number) and time.monotonic() < until_s:
        rclpy.spin_once(node, timeout_sec=0.1)
    sys.stdout.write(json.dumps(heard) + "\n")
    sys.stdout.flush()


def command(kind: str) -> None:
    """Command the vehicle `hero`: full throttle, what is no number, a flood, or an Ackermann command."""
    node = Node("commander")
    if kind == "ackermann":
        message = class_of("ackermann_msgs/msg/AckermannDriveStamped")()
        message.drive.speed, message.drive.acceleration, message.drive.steering_angle = 3.0, 2.0, 0.3
        publisher = node.create_publisher(type(message), "/carla/hero/ackermann_control_cmd", profile())
    else:
        message = class_of("carla_msgs/msg/CarlaEgoVehicleControl")(throttle=0.75)
        if kind == "nan":
            message.throttle = float("nan")
        is_reliable = kind != "best-effort"
        topic = "/carla/hero/vehicle_control_cmd"
        publisher = node.create_publisher(type(message), topic, profile(is_reliable=is_reliable))
    period_s = 0.0005 if kind == "flood" else 0.02
    node.create_timer(period_s, lambda: publisher.publish(message))
    rclpy.spin(node)


def fill(message: object, fields: dict[str, object]) -> None:
    """Set fields of a message; those of a message inside it are a dictionary, key and value pairs a list of two."""
    for name, value in fields.items():
        if isinstance(value, dict):
            fill(getattr(message, name), value)
        elif name == "attributes":
            setattr(message, name, [KeyValue(key=key, value=text) for key, text in value])
        else:
            setattr(message, name, value)


def call() -> None:
    """Call services, and print each answer with the seconds that it took and the names of all services."""
    node, clients = Node("caller"), {}
    for line in sys.stdin:
        name, kind, fields = json.loads(line)
        package, _, service = kind.split("/")
        made = getattr(importlib.import_module(f"{package}.srv"), service)
        client = clients.setdefault(name, node.create_client(made, name))
        request = made.Request()
        fill(request, fields)
        is_ready = client.wait_for_service(LONGEST_S)
        began_s = time.monotonic()
        future = client.call_async(request)
        rclpy.spin_until_future_complete(node, future, timeout_sec=LONGEST_S)
        found = future.result()
        answer = found and {name: getattr(found, name) for name in found.get_fields_and_field_types()}
        rest = {"ready": is_ready, "took_s": time.monotonic() - began_s, "services": node.get_service_names_and_types()}
        sys.stdout.write(json.dumps({"answer": answer, **rest}) + "\n")
        sys.stdout.flush()


def weather() -> None:
    """Publish a weather again and again."""
    node = Node("weather_maker")
    message = class_of("carla_msgs/msg/CarlaWeatherParameters")(cloudiness=40.0, sun_altitude_angle=12.5)
    publisher = node.create_publisher(type(message), "/carla/weather_control", profile())
    node.create_timer(0.05, lambda: publisher.publish(message))
    rclpy.spin(node)


def main(role: str, *words: str) -> None:
    rclpy.init()
    roles = {
        "hear": hear, "drive": drive, "publish": publish, "count": count, "command": command, "call": call,
        "weather": weather,
    }  # fmt: skip
    try:
        roles[role](*words)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()  # its shared memory goes with it


if __name__ == "__main__":
    main(*sys.argv[1:])
