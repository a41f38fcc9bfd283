"""Autoware Universe's `autoware_carla_interface`, unmodified, on `linden serve`: its topics beside ours, and a drive.

    python scripts/outside/autoware_carla_interface.py NODE MESSAGES WORK [--objects FILE] [--ticks 200] [-o table.md]

NODE is the folder ``simulator/autoware_carla_interface`` of autoware.universe, MESSAGES the folder
``tier4_vehicle_msgs`` of tier4_autoware_msgs. WORK gets the environment of the node: rclpy is that of the tests
(``scripts/setup dev``), messages are made by the generators of its wheels, ``carla`` and ``transforms3d`` come from
PyPI, and a module of some lines takes the place of ``cv_bridge``. The program itself is not changed.

The server publishes on a ROS domain of its own (``linden serve --ros2``), so the topics of both do not mix. The
exit code is 0 if each topic came, each compared field that must be equal is equal, and the vehicle obeyed.
"""
# ruff: noqa: ANN401 - messages of ROS

from __future__ import annotations

import argparse
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections import defaultdict
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import carla
import numpy as np
from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
from ros_bridge import Collector, cpu_s, differences, stamp_ns
from rosbags.typesys import get_types_from_msg

from basu_ros import autoware
from basu_ros.dds import Ros2Node
from linden_ros2.dds_domain import joined
from linden_ros2.topic import CLOCK, Message, Topic
from linden_ros2.types import Generation, types_of

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from rclpy_environment import PLACE, SIDE, made_rclpy  # noqa: E402 - of the tests

ROLE, MODULE, VEHICLE = "hero", "autoware_carla_interface.carla_autoware", "vehicle.toyota.prius"
PACKAGES = ("carla==0.9.16", "transforms3d==0.4.2", "six==1.17.0")
ACTUATION = ("ActuationCommand", "ActuationCommandStamped", "ActuationStatus", "ActuationStatusStamped")
CV_BRIDGE = '''"""The part of cv_bridge that the node calls."""
import array

from sensor_msgs.msg import Image


class CvBridge:
    def cv2_to_imgmsg(self, picture, encoding):
        height, width = picture.shape[:2]
        data = array.array("B", picture.tobytes())
        return Image(height=height, width=width, encoding=encoding, step=picture.strides[0], data=data)
'''
READY = re.compile(r"linden: ready, rpc port (\d+)")
LONG_S, ENDS_S = 180.0, 20.0
STEP_S = 0.05
COMMAND = Topic("/control/command/actuation_cmd", "tier4_vehicle_msgs/msg/ActuationCommandStamped", depth=1)
START = Topic("/initialpose", "geometry_msgs/msg/PoseWithCovarianceStamped", depth=1)
POSE = Topic("/sensing/gnss/pose_with_covariance", "geometry_msgs/msg/PoseWithCovarianceStamped")
ACTUATED = Topic("/vehicle/status/actuation_status", "tier4_vehicle_msgs/msg/ActuationStatusStamped")
IMAGE = Topic("/sensing/camera/traffic_light/image_raw", "sensor_msgs/msg/Image")
INFO = Topic("/sensing/camera/traffic_light/camera_info", "sensor_msgs/msg/CameraInfo")
LIDAR = autoware.LIDAR._replace(is_reliable=True)
STATES = (autoware.VELOCITY, autoware.STEERING, autoware.GEAR, autoware.MODE)
PUBLISHED = (CLOCK, IMAGE, INFO, LIDAR, autoware.IMU, POSE, *STATES, ACTUATED)
"""What the node publishes."""
NATIVE = {"camera.rgb": (IMAGE, INFO), "lidar.ray_cast": (LIDAR,), "other.imu": (autoware.IMU,)}
"""The node's topics of each kind of sensor, in the order of the server's own."""
XYZIRC = np.dtype([("xyz", "<f4", 3), ("intensity", "u1"), ("return_type", "u1"), ("channel", "<u2")])


class Command(NamedTuple):
    """Pedals from 0 to 1 and a steering command, positive to the left, for some seconds of simulated time."""

    name: str
    accel: float
    brake: float
    steer: float
    lasts_s: float


BEND = Command("a bend", 0.5, 0.0, 0.1, 0.0)
DRIVE = (
    Command("accelerator 0.6", 0.6, 0.0, 0.0, 4.0),
    Command("steering 0.3, to the left", 0.3, 0.0, 0.3, 1.5),
    Command("brake 0.8", 0.0, 0.8, 0.0, 3.0),
)


def main() -> int:
    """Compare and drive; print the tables, and return 1 if something did not come, differs or was not obeyed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("node", type=Path)
    parser.add_argument("messages", type=Path)
    parser.add_argument("work", type=Path)
    parser.add_argument("--objects", type=Path, help="another file of sensors than the node's own")
    parser.add_argument("--ticks", type=int, default=200, help="frames in which topics are compared")
    parser.add_argument("-o", "--output", type=Path, help="write the tables to a file as well")
    args = parser.parse_args()
    environment = prepared(args.node.resolve(), args.messages.resolve(), args.work.resolve())
    domain = 1 + os.getpid() % 100
    objects = (args.objects or args.node / "config/objects.json").resolve()
    wrong: list[str] = []
    with ExitStack() as stack:
        lines = [*run(stack, environment, objects, domain, args.ticks, args.work.resolve(), wrong)]
    lines += ["", *(f"WRONG: {each}" for each in wrong)]
    print("\n".join(lines))
    if args.output is not None:
        args.output.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return int(bool(wrong))


def prepared(node: Path, messages: Path, work: Path) -> dict[str, str]:
    """Make what the node imports, once, and return the variables of its process."""
    python, site, made, shims = made_rclpy(), work / "site", work / "messages", work / "shims"
    if not site.is_dir():
        install = [str(python), "-m", "pip", "install", "--quiet", "--no-deps", "--target", str(site), *PACKAGES]
        subprocess.run(install, check=True)
    if not made.is_dir():
        definitions = work / "definitions"
        own = ROOT / "packages/linden-ros2/src/linden_ros2/definitions/autoware_vehicle_msgs"
        shutil.copytree(own, definitions / own.name)
        (definitions / "tier4_vehicle_msgs").mkdir()
        for name in ACTUATION:
            shutil.copy(messages / "msg" / f"{name}.msg", definitions / "tier4_vehicle_msgs")
        subprocess.run([str(python), str(SIDE / "messages.py"), str(definitions), str(made)], check=True)
    shims.mkdir(exist_ok=True)
    (shims / "cv_bridge.py").write_text(CV_BRIDGE, encoding="utf-8")
    store = types_of(Generation.ROS_2).store
    for name in ACTUATION:
        text = (messages / "msg" / f"{name}.msg").read_text(encoding="utf-8")
        store.register(get_types_from_msg(text, f"tier4_vehicle_msgs/msg/{name}"))
    path = os.pathsep.join(map(str, (node / "src", shims, made, site)))
    return {**os.environ, "AMENT_PREFIX_PATH": str(PLACE), "PYTHONPATH": path}


def run(
    stack: ExitStack, environment: dict[str, str], objects: Path, domain: int, ticks: int, work: Path, wrong: list[str]
) -> Iterator[str]:
    """Start server and node, compare their topics, drive by the node's topics, and yield the lines of the tables."""
    port, server = started_server(stack, domain + 1, work)
    node = started_node(stack, environment, objects, domain, port, work)
    theirs, ours = Ros2Node("comparison", domain), Ros2Node("comparison", domain + 1)
    stack.callback(theirs.close)
    stack.callback(ours.close)
    theirs.listen(*(topic._replace(depth=1000) for topic in PUBLISHED))
    theirs.announce(COMMAND, START)
    client = carla.Client("127.0.0.1", port)
    client.set_timeout(LONG_S)
    vehicle = vehicle_of(client, node)
    native = native_topics(stack, domain + 1, vehicle)
    ours.listen(*native, CLOCK)
    collected = Collector(client.get_world(), vehicle, [])
    stack.callback(collected.stop)
    heard: dict[str, dict[int, Any]] = defaultdict(dict)
    own: dict[str, dict[int, Any]] = defaultdict(dict)
    began_s, began_cpu = time.monotonic(), (cpu_s(server.pid), cpu_s(node.pid))
    listen(theirs, heard, ours, [*native, CLOCK], own, ticks)
    wall_s, frames = time.monotonic() - began_s, max(1, len(heard[CLOCK.name]))
    spent = [1e3 * (cpu_s(each.pid) - at) / frames for each, at in zip((server, node), began_cpu, strict=True)]
    yield f"{frames} frames in {wall_s:.1f} s; processor ms a frame: server {spent[0]:.0f}, node {spent[1]:.0f}"
    status = ours_of(collected, vehicle)
    yield from comparison(heard, own, status, native, wall_s, wrong)
    yield from driven(theirs, vehicle, wrong)
    node.send_signal(signal.SIGINT)
    try:
        yield f"Ctrl+C: the node ended with {node.wait(ENDS_S)}"
    except subprocess.TimeoutExpired:
        yield f"Ctrl+C: the node had not ended after {ENDS_S:g} s, and was killed"
        node.kill()


def started_server(stack: ExitStack, domain: int, work: Path) -> tuple[int, subprocess.Popen[str]]:
    """Start `linden serve --ros2` on a domain, and return its port and its process."""
    command = [sys.executable, "-m", "linden.cli", "serve", "--port", "0", "--ros2"]
    environment = {**os.environ, "ROS_DOMAIN_ID": str(domain)}
    log = stack.enter_context((work / "server.log").open("w"))
    process = stack.enter_context(
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=log, text=True, env=environment)
    )
    stack.callback(process.terminate)
    assert process.stdout is not None
    for line in process.stdout:
        if (found := READY.search(line)) is not None:
            return int(found[1]), process
    raise SystemExit(f"linden serve did not start; see {work}/server.log")


def started_node(
    stack: ExitStack, environment: dict[str, str], objects: Path, domain: int, port: int, work: Path
) -> subprocess.Popen[bytes]:
    """Start the node with the parameters of its launch file; only host, port, time-out, map and role are ours."""
    given = {
        "host": "127.0.0.1", "port": port, "timeout": int(LONG_S), "sync_mode": "true", "fixed_delta_seconds": STEP_S,
        "carla_map": "Linden", "ego_vehicle_role_name": ROLE, "spawn_point": "None", "vehicle_type": VEHICLE,
        "objects_definition_file": objects, "use_traffic_manager": "false", "max_real_delta_seconds": STEP_S,
    }  # fmt: skip
    words = [word for name, value in given.items() for word in ("-p", f"{name}:={value}")]
    log = stack.enter_context((work / "node.log").open("w"))
    process = stack.enter_context(
        subprocess.Popen(
            [str(PLACE / "bin" / "python"), "-m", MODULE, "--ros-args", *words],
            env={**environment, "ROS_DOMAIN_ID": str(domain)},
            stdout=log,
            stderr=log,
        )
    )
    stack.callback(process.kill)
    return process


def vehicle_of(client: carla.Client, node: subprocess.Popen[bytes]) -> carla.Vehicle:
    """Return the vehicle that the node has spawned, once it carries the four sensors.

    Raises:
        SystemExit: the node ended, or spawned none.
    """
    until_s = time.monotonic() + LONG_S
    while time.monotonic() < until_s and node.poll() is None:
        world = client.get_world()
        found = [each for each in world.get_actors().filter(VEHICLE) if each.attributes["role_name"] == ROLE]
        if found and len(world.get_actors().filter("sensor.*")) == 4:
            return found[0]
        time.sleep(0.5)
    raise SystemExit("the node spawned no vehicle with its sensors; see node.log")


def native_topics(stack: ExitStack, domain: int, vehicle: carla.Vehicle) -> dict[Topic, Topic]:
    """Return the server's own topics of the node's sensors, and the node's topic of the same measurement."""
    participant = joined(domain)
    reader = BuiltinDataReader(participant, BuiltinTopicDcpsPublication)
    stack.callback(lambda: participant)
    found: dict[Topic, Topic] = {}
    until_s = time.monotonic() + LONG_S
    while len(found) < sum(map(len, NATIVE.values())) and time.monotonic() < until_s:
        for each in reader.take(N=1000):
            name = getattr(each, "topic_name", "")
            for kind, topics in NATIVE.items():
                last = kind.rpartition(".")[2]
                match = re.fullmatch(rf"rt(/carla/{ROLE}/{last}\d+)(|/image|/camera_info)", name)
                if match is not None:
                    topic = topics[match[2] == "/camera_info"]
                    found[Topic(match[1] + match[2], topic.type, depth=1000)] = topic
        time.sleep(0.1)
    assert vehicle.is_alive
    return found


def listen(theirs: Ros2Node, heard: Any, ours: Ros2Node, native: Any, own: Any, ticks: int) -> None:
    """Keep the messages of both by topic and time for a number of frames, and drive a bend meanwhile.

    Raises:
        SystemExit: the node is silent.
    """
    until_s = time.monotonic() + LONG_S
    while len(heard[CLOCK.name]) < ticks:
        if time.monotonic() > until_s:
            raise SystemExit("no clock came from the node; see node.log")
        theirs.wait(CLOCK, 0.5)
        if heard[CLOCK.name]:  # before its first frame the node's callback of commands has no time and ends with it
            theirs.publish(actuation(theirs, BEND))
        for node, names, kept in ((theirs, PUBLISHED, heard), (ours, native, own)):
            for topic in names:
                for message in node.received(topic._replace(depth=1000)):
                    kept[topic.name][time_ns(topic, message)] = message
                    until_s = time.monotonic() + LONG_S


def time_ns(topic: Topic, message: Any) -> int:
    """Return the stamp of a message in ns, to the microsecond; some of Autoware's have it without a header."""
    if hasattr(message, "stamp"):
        return round((message.stamp.sec * 1_000_000_000 + message.stamp.nanosec) / 1000.0) * 1000
    return stamp_ns(topic, message)


def ours_of(collected: Collector, vehicle: carla.Vehicle) -> dict[str, dict[int, Any]]:
    """Return what `basu run autoware` would publish of the same frames, by topic and time."""
    types, made = types_of(Generation.ROS_2), defaultdict[str, dict[int, Any]](dict)
    collected.stop()
    widest_deg = max(wheel.max_steer_angle for wheel in vehicle.get_physics_control().wheels)
    for moment in collected.moments(vehicle):
        tyre_rad = -math.radians(widest_deg) * moment.control.steer  # as commanded
        for topic, content in autoware.autoware_messages(types, collected.described, moment, tyre_rad):
            if topic in (*STATES, autoware.KINEMATIC):
                made[topic.name][time_ns(topic, content)] = content
    return made


def comparison(
    heard: dict[str, dict[int, Any]],
    own: dict[str, dict[int, Any]],
    status: dict[str, dict[int, Any]],
    native: dict[Topic, Topic],
    wall_s: float,
    wrong: list[str],
) -> Iterator[str]:
    """Yield a row for each topic of the node: type, frame, rate, and how its values differ from ours."""
    counterpart = {theirs: own[topic.name] for topic, theirs in native.items()}
    counterpart |= {topic: status[topic.name] for topic in STATES} | {POSE: status[autoware.KINEMATIC.name]}
    counterpart[CLOCK] = own[CLOCK.name]
    names = {theirs: topic.name for topic, theirs in native.items()}
    names |= {topic: f"{topic.name} (BASU)" for topic in STATES} | {POSE: f"{autoware.KINEMATIC.name} (BASU)"}
    names[CLOCK] = CLOCK.name
    offset_ns = offset_of(heard[LIDAR.name], counterpart.get(LIDAR, {}))
    if offset_ns is None:
        wrong.append("no point cloud of the node is one of the server's own")
        return
    yield f"the node's time begins at {offset_ns * 1e-9:.2f} s of the server's"
    yield ""
    yield "| topic | type | frame | a second | ours | frame | frames compared | fields that differ (largest) |"
    yield "|---|---|---|---|---|---|---|---|"
    for topic in PUBLISHED:
        messages, mine = heard[topic.name], counterpart.get(topic, {})
        if not messages:
            wrong.append(f"nothing came on {topic.name}")
            continue
        pairs = [(each, mine[at + offset_ns]) for at, each in messages.items() if at + offset_ns in mine]
        differing: dict[str, float] = {}
        for first, second in pairs:
            for path, difference in compared(topic, first, second):
                if difference > 0.0:
                    differing[path] = max(difference, differing.get(path, 0.0))
        told = ", ".join(f"{path} {size:.3g}" for path, size in sorted(differing.items())) or "none"
        if mine and not pairs:
            wrong.append(f"no frame of {topic.name} is one of ours")
        frames = [frame_of(next(iter(kept.values()), None)) for kept in (messages, mine)]
        rate, ours = len(messages) / wall_s, f"`{names[topic]}`" if topic in names else "none"
        values = (f"`{topic.name}`", topic.type, frames[0], f"{rate:.1f}", ours, frames[1], len(pairs))
        yield f"| {' | '.join(map(str, values))} | {told if mine else ''} |"
        if topic in (IMAGE, INFO, LIDAR, autoware.IMU, autoware.GEAR, autoware.MODE, CLOCK) and differing:
            wrong.append(f"{topic.name} differs: {told}")


def offset_of(theirs: dict[int, Any], ours: dict[int, Any]) -> int | None:
    """Return the server's time minus the node's, in ns, from the first cloud that both have; None without one."""
    for at, cloud in theirs.items():
        points = points_of(cloud)[0]
        for own_at, own in ours.items():
            if own.width == cloud.width and np.array_equal(points, points_of(own)[0]):
                return own_at - at
    return None


def points_of(cloud: Any) -> tuple[Any, Any]:
    """Return the places of a cloud's points, and their intensities from 0 to 255 as whole numbers."""
    if len(cloud.fields) == len(XYZIRC) + 2:  # x, y and z are one in `XYZIRC`
        rows = np.frombuffer(cloud.data.tobytes(), XYZIRC)
        return rows["xyz"], rows["intensity"]
    values = np.frombuffer(cloud.data.tobytes(), "<f4").reshape(-1, 4)
    return values[:, :3], (np.clip(values[:, 3], 0.0, 1.0) * 255).astype(np.uint8)


def compared(topic: Topic, theirs: Any, ours: Any) -> Iterator[tuple[str, float]]:
    """Yield how far fields of the same frame are apart; stamps and frames are compared elsewhere."""
    if topic == CLOCK:
        return
    if topic == LIDAR:
        yield "points", float(np.max(np.abs(points_of(theirs)[0] - points_of(ours)[0]), initial=0.0))
        away = points_of(theirs)[1].astype(int) - points_of(ours)[1].astype(int)
        yield "intensity", float(np.max(np.abs(away), initial=0))
        return
    if topic == POSE:
        theirs, ours = theirs.pose.pose, ours.pose.pose
    for path, difference in differences(theirs, ours, ""):
        if not path.startswith(("header", "stamp")) and "covariance" not in path:
            yield path, difference


def frame_of(message: Any) -> str:
    """Return the frame in a message's header; nothing for a message without one."""
    return str(getattr(getattr(message, "header", None), "frame_id", ""))


def driven(node: Ros2Node, vehicle: carla.Vehicle, wrong: list[str]) -> Iterator[str]:
    """Send a start pose and the commands of `DRIVE` by the node's topics, and yield what the vehicle did."""
    types = node.types
    brake, start = DRIVE[-1], vehicle.get_world().get_map().get_spawn_points()[3]
    pose = types.message("geometry_msgs/msg/PoseWithCovariance")
    pose.pose.position.x, pose.pose.position.y = start.location.x, -start.location.y
    pose.pose.position.z = start.location.z
    turn = -math.radians(start.rotation.yaw) / 2.0
    pose.pose.orientation.z, pose.pose.orientation.w = math.sin(turn), math.cos(turn)
    send(node, vehicle, brake)
    node.publish(Message(START, types.message(START.type, pose=pose)))
    send(node, vehicle, brake)
    away = vehicle.get_transform().location.distance(start.location)
    yield f"/initialpose: the vehicle stands {away:.2f} m from the pose"
    if away > 2.0:
        wrong.append(f"/initialpose put the vehicle {away:.1f} m from the pose")
    yield ""
    yield "| command | speed before, m/s | speed after, m/s | driven, m | turned, deg (positive to the left) |"
    yield "|---|---|---|---|---|"
    seen = []
    for command in DRIVE:
        before, speed = vehicle.get_transform(), vehicle.get_velocity().length()
        send(node, vehicle, command)
        after = vehicle.get_transform()
        turned = -math.remainder(after.rotation.yaw - before.rotation.yaw, 360.0)
        way, now = after.location.distance(before.location), vehicle.get_velocity().length()
        seen.append((now, turned))
        yield f"| {command.name} for {command.lasts_s} s | {speed:.2f} | {now:.2f} | {way:.1f} | {turned:.1f} |"
    if seen[0][0] < 3.0 or seen[1][1] < 3.0 or seen[2][0] > seen[1][0] / 2.0:
        wrong.append(f"the vehicle did not obey: {seen}")
    send(node, vehicle, Command("no number", math.nan, 0.0, 0.0, 1.0))
    control = vehicle.get_control()
    yield f"accelerator nan for 1 s: the server has the throttle {control.throttle:g}"


def send(node: Ros2Node, vehicle: carla.Vehicle, command: Command) -> None:
    """Publish a command for its time in the simulation."""
    world = vehicle.get_world()
    began_s, sent = world.get_snapshot().timestamp.elapsed_seconds, 0
    until_s = time.monotonic() + LONG_S
    while time.monotonic() < until_s:
        now = world.get_snapshot().timestamp
        if now.elapsed_seconds - began_s >= command.lasts_s:
            return
        if now.frame != sent:  # the node steers straight on if a second command comes within a frame
            node.publish(actuation(node, command))
            sent = now.frame
        time.sleep(STEP_S / 10.0)


def actuation(node: Ros2Node, command: Command) -> Message:
    """Return a command as a message of the node's topic."""
    given = {"accel_cmd": command.accel, "brake_cmd": command.brake, "steer_cmd": command.steer}
    content = node.types.message("tier4_vehicle_msgs/msg/ActuationCommand", **given)
    return Message(COMMAND, node.types.message(COMMAND.type, actuation=content))


if __name__ == "__main__":
    sys.exit(main())
