"""CARLA's official ros-bridge and our messages on one `linden serve`: the same moments field by field, rates, costs.

    python scripts/outside/ros_bridge.py SOURCES SITE [--ticks 100] [--camera] [-o table.md]

SOURCES has ros-bridge, ros-carla-msgs, astuff_sensor_msgs and ackermann_msgs, a folder each; SITE the bridge's Python
packages (docs/how-to/ros.md). The bridge runs unmodified but for its version line, under the system's Python. It ticks
the world and spawns vehicle and sensors. A second client here listens to the same sensors. Its moments become our
messages. Without SOURCES or ROS 1 the script says so and ends.
"""
# ruff: noqa: ANN401, FBT001 - messages of ROS

from __future__ import annotations

import argparse
import json
import math
import os
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import carla
import numpy as np

from basu.records.motion import motion_of
from basu_ros.agents.vehicle_source import control_of, info_message
from basu_ros.moment import Actor, Light, Measurement, Moment, Motion, Vehicle
from basu_ros.ros1 import Ros1Node
from basu_ros.topics import LIGHTS, info_of, moment_messages, vehicle_topics
from linden_ros2.mount import Mount
from linden_ros2.topic import Message, Topic

if TYPE_CHECKING:
    from collections.abc import Iterator

ROLE = "ego_vehicle"
SENSORS = [
    {"type": "sensor.lidar.ray_cast", "id": "lidar", "z": 2.4, "range": 50, "channels": 32, "points_per_second": 320000,
     "upper_fov": 2.0, "lower_fov": -26.8, "rotation_frequency": 20, "noise_stddev": 0.0},
    {"type": "sensor.lidar.ray_cast_semantic", "id": "semantic_lidar", "z": 2.4, "range": 50, "channels": 32,
     "points_per_second": 320000, "upper_fov": 2.0, "lower_fov": -26.8, "rotation_frequency": 20},
    {"type": "sensor.other.radar", "id": "radar_front", "x": 2.0, "z": 2.0, "horizontal_fov": 30.0,
     "vertical_fov": 10.0, "points_per_second": 1500, "range": 100.0},
    {"type": "sensor.other.gnss", "id": "gnss", "x": 1.0, "z": 2.0},
    {"type": "sensor.other.imu", "id": "imu", "x": 2.0, "z": 2.0},
]  # fmt: skip
CAMERAS = [
    {"type": f"sensor.camera.{kind}", "id": name, "x": 2.0, "z": 2.0, "image_size_x": 400, "image_size_y": 300,
     "fov": 90.0}
    for kind, name in (("rgb", "rgb_front"), ("depth", "depth_front"), ("semantic_segmentation", "semantic_front"))
]  # fmt: skip
PSEUDO = ("traffic_lights", "objects", "actor_list", "markers", "opendrive_map")
PACKAGES = {
    "carla_msgs": "ros-carla-msgs",
    "ackermann_msgs": "ackermann_msgs",
    "derived_object_msgs": "astuff_sensor_msgs/derived_object_msgs",
    "carla_ackermann_msgs": "ros-bridge/carla_ackermann_msgs",
}
UNWANTED = ("CipvTrack", "Lane", "LaneModels")  # they need a radar's messages, and the bridge does not use them
READY = re.compile(r"linden: ready, rpc port (\d+)")
LONG_S = 120.0
STAMP_NS = 1000  # the bridge cuts its sums of steps off, ours rounds them to the microsecond
TOLERANCE = 2e-4  # absolute, or relative to large values: single precision on the wire


def main() -> int:
    """Compare, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sources", type=Path)
    parser.add_argument("site", type=Path)
    parser.add_argument("--ticks", type=int, default=100)
    parser.add_argument("--camera", action="store_true", help="with cameras of 400x300")
    parser.add_argument("-o", "--output", type=Path, help="write the tables to a file as well")
    args = parser.parse_args()
    if not (args.sources / "ros-bridge").is_dir() or not args.site.is_dir() or shutil.which("roscore") is None:
        print("skipped: the sources of ros-bridge, its Python packages or ROS 1 are not here; see docs/how-to/ros.md")
        return 0
    with ExitStack() as stack:
        table = "\n".join(compare(stack, args.sources.resolve(), args.site.resolve(), args.ticks, args.camera))
    print(table)
    if args.output is not None:
        args.output.write_text(table + "\n", encoding="utf-8")
    return 0


def compare(stack: ExitStack, sources: Path, site: Path, ticks: int, with_cameras: bool) -> Iterator[str]:
    """Run both, and yield the lines of the tables."""
    work = Path(stack.enter_context(tempfile.TemporaryDirectory()))
    made = generated_messages(sources, work / "generated")
    (sources / "ros-bridge/carla_ros_bridge/src/carla_ros_bridge/CARLA_VERSION").write_text("0.9.16\n")
    port = started_server(stack)
    environment = started_roscore(stack, work)
    os.environ.update({name: environment[name] for name in ("ROS_MASTER_URI", "ROS_HOSTNAME")})
    bridge_environment = {**environment, "PYTHONPATH": search_path(sources, site, made)}
    specs = [*SENSORS, *(CAMERAS if with_cameras else [])]
    bridge = started_bridge(stack, sources, bridge_environment, port)
    spawn(stack, sources, bridge_environment, specs, work)
    client = carla.Client("127.0.0.1", port)
    client.set_timeout(60.0)
    world = client.get_world()
    vehicle = ego_of(world)
    for point in world.get_map().get_spawn_points()[:40:10]:
        world.try_spawn_actor(world.get_blueprint_library().find("vehicle.audi.tt"), point)
    world.wait_for_tick()
    listener = Ros1Node("comparison")
    stack.callback(listener.close)
    theirs = topics_of(specs)
    listener.listen(*theirs)
    collected = Collector(world, vehicle, specs)
    stack.callback(collected.stop)
    vehicle.set_autopilot(True)
    messages: dict[str, dict[int, Any]] = defaultdict(dict)
    began_cpu_s, began_s = cpu_s(bridge.pid), time.monotonic()
    until_s = began_s + LONG_S
    while len(messages["/clock"]) < ticks and time.monotonic() < until_s:
        listener.wait_any(theirs, 1.0)
        for topic in theirs:
            for message in listener.received(topic):
                messages[topic.name][stamp_ns(topic, message)] = message
    wall_s, bridge_s = time.monotonic() - began_s, cpu_s(bridge.pid) - began_cpu_s
    collected.stop()
    frames = len(messages["/clock"])
    yield f"{frames} ticks in {wall_s:.1f} s of wall time; sensors: {', '.join(str(spec['id']) for spec in specs)}"
    moments = collected.moments(vehicle)
    ours, tick_ms, process_ms = published(moments, collected.described, vehicle)
    yield from rows_of(theirs, messages, ours, frames)
    yield ""
    yield "| processor time of one tick, ms | publisher's own thread | its processes |"
    yield "|---|---|---|"
    yield f"| official ros-bridge | | {1e3 * bridge_s / max(1, frames):.1f} |"
    yield f"| ours, ROS 1 (rospy in a process) | {tick_ms:.1f} | {process_ms:.1f} |"


class Collector:
    """Collects, as a second client, what our messages are made of: snapshots and measurements by frame."""

    def __init__(self, world: carla.World, vehicle: carla.Vehicle, specs: list[dict[str, Any]]) -> None:
        """Begin to listen."""
        self._world, self._snapshots, self._data = world, {}, defaultdict(dict)
        self._sensors: list[carla.Sensor] = []
        mounts = []
        for spec in specs:
            alike = world.get_actors().filter(str(spec["type"]))
            sensor = next(actor for actor in alike if actor.attributes["role_name"] == spec["id"])
            mounts.append(mount_of(spec))
            sensor.listen(lambda data, name=str(spec["id"]): self._data[data.frame].__setitem__(name, data))
            self._sensors.append(sensor)
        self.described = Vehicle(ROLE, mounts)
        self._lights = sorted(world.get_actors().filter("traffic.traffic_light"), key=lambda light: light.id)
        self._vehicle = vehicle
        self._others = [other for other in world.get_actors().filter("vehicle.*") if other.id != vehicle.id]
        self._callback: int | None = world.on_tick(self._keep)

    def _keep(self, snapshot: carla.WorldSnapshot) -> None:
        """Keep a snapshot with the control that was applied."""
        lights = tuple(Light(light.id, int(light.get_state())) for light in self._lights)
        self._snapshots[snapshot.frame] = (snapshot, control_of(self._vehicle.get_control()), lights)

    def stop(self) -> None:
        """Stop listening."""
        if self._callback is not None:
            self._world.remove_on_tick(self._callback)
            self._callback = None
            for sensor in self._sensors:
                sensor.stop()

    def moments(self, vehicle: carla.Vehicle) -> list[Moment]:
        """Return the frames in which every sensor measured."""
        made, before = [], None
        for frame, (snapshot, control, lights) in sorted(self._snapshots.items()):
            data = self._data.get(frame, {})
            own = snapshot.find(vehicle.id)
            if own is None or len(data) < len(self.described.mounts):
                continue
            measured = [Measurement(mount, data[mount.id]) for mount in self.described.mounts]
            t_s = snapshot.timestamp.elapsed_seconds
            others = [_actor(other, snapshot.find(other.id)) for other in self._others]
            motion, changed = Motion(*motion_of(own)), lights if lights != before else ()
            made.append(Moment(t_s, frame, motion, control, others, changed, measured))
            before = lights
        return made


def _actor(other: carla.Vehicle, seen: carla.ActorSnapshot) -> Actor:
    """Another vehicle: the middle of its box."""
    box, pose, velocity = other.bounding_box, seen.get_transform(), seen.get_velocity()
    middle, size = pose.transform(box.location), box.extent
    place = (middle.x, middle.y, middle.z, math.radians(pose.rotation.yaw))
    return Actor(other.id, other.type_id, *place, velocity.x, velocity.y, size.x, size.y)


def published(
    moments: list[Moment], described: Vehicle, vehicle: carla.Vehicle
) -> tuple[dict[str, dict[int, Any]], float, float]:
    """Publish our messages of the moments with a subscriber; the messages by time, and processor ms a tick."""
    node, other = Ros1Node("ours"), Ros1Node("ours_listener")
    mine = [topic._replace(name=f"/ours{topic.name}") for topic in vehicle_topics(described)]
    node.announce(*mine)
    other.listen(*mine)
    for topic in mine:
        node.wait_for_peers(topic, 30.0)
    kept: dict[str, dict[int, Any]] = defaultdict(dict)
    began_s, process_s = time.thread_time(), cpu_s(node.pid)
    for moment in moments:
        for topic, content in moment_messages(node.types, described, moment):
            node.publish(Message(topic._replace(name=f"/ours{topic.name}"), content))
            kept[topic.name][stamp_ns(topic, content) or round(moment.t_s * 1e6) * 1000] = content
    spent_s = time.thread_time() - began_s
    node.publishers_of("/clock")  # an answer comes after all that was sent before
    process_s = cpu_s(node.pid) - process_s
    info = info_message(node.types, vehicle)
    kept[info.topic.name][0] = info.content
    other.close()
    node.close()
    count = max(1, len(moments))
    return kept, 1e3 * spent_s / count, 1e3 * (process_s + spent_s) / count


def rows_of(
    topics: list[Topic], theirs: dict[str, dict[int, Any]], ours: dict[str, dict[int, Any]], frames: int
) -> Iterator[str]:
    """Yield a row a topic: how often it comes, how many moments both have, and which fields differ most."""
    yield ""
    yield "| topic | official, a tick | ours, a tick | moments compared | equal fields | fields that differ (largest) |"
    yield "|---|---|---|---|---|---|"
    for topic in topics:
        a, b = theirs[topic.name], ours[topic.name]
        latched = topic == info_of(ROLE)
        if (latched or topic == LIGHTS) and a and b:
            pairs = [(next(iter(a.values())), next(iter(b.values())))]
        else:
            pairs = [(a[t], b[t]) for t in a if t in b]
        differing: dict[str, float] = {}
        equal: set[str] = set()
        for first, second in pairs:
            for path, difference in differences(first, second, ""):
                if difference > 0.0:
                    differing[path] = max(difference, differing.get(path, 0.0))
                else:
                    equal.add(path)
        told = ", ".join(f"{path} {size:.3g}" for path, size in sorted(differing.items())[:6]) or "none"
        own = len(b) / max(1, max((len(each) for each in ours.values()), default=1))
        rate = "once" if latched else f"{len(a) / max(1, frames):.2f}"
        mine = "once" if latched else f"{own:.2f}"
        yield f"| `{topic.name}` | {rate} | {mine} | {len(pairs)} | {len(equal - {*differing})} | {told} |"


def differences(a: Any, b: Any, path: str) -> Iterator[tuple[str, float]]:
    """Yield the path of each field and how far both are apart; inf where they cannot be compared, 0 where equal."""
    if path.endswith(".seq"):
        return
    if hasattr(a, "__dataclass_fields__"):
        for name in a.__dataclass_fields__:
            if name != "__msgtype__":
                yield from differences(getattr(a, name), getattr(b, name), f"{path}.{name}".lstrip("."))
    elif isinstance(a, np.ndarray):
        yield path, array_difference(np.asarray(a), np.asarray(b), path)
    elif isinstance(a, list):
        yield f"{path} (count)", float(abs(len(a) - len(b)))
        a, b = (sorted(each, key=lambda item: getattr(item, "id", 0)) for each in (a, b))
        for first, second in zip(a, b, strict=False):
            yield from differences(first, second, f"{path}[]")
    elif isinstance(a, float):
        away = abs(a - b)
        yield path, 0.0 if away <= TOLERANCE * max(1.0, abs(a)) else away
    elif path.endswith(".nanosec"):
        yield path, 0.0 if abs(a - b) <= STAMP_NS else float(abs(a - b))
    else:
        yield path, 0.0 if a == b else float("inf")


def array_difference(a: Any, b: Any, path: str) -> float:
    """How far two arrays are apart; bytes of clouds are compared as single-precision numbers."""
    if a.shape != b.shape:
        return float("inf")
    if a.dtype == np.uint8 and path == "data" and a.size % 4 == 0 and not np.array_equal(a, b):
        a, b = a.view("<f4"), b.view("<f4")
    if np.array_equal(a, b):
        return 0.0
    away = np.abs(a.astype(np.float64) - b.astype(np.float64))
    most = float(np.nanmax(away))
    return 0.0 if most <= TOLERANCE else most


def topics_of(specs: list[dict[str, Any]]) -> list[Topic]:
    """The topics that both publish."""
    found = vehicle_topics(Vehicle(ROLE, [mount_of(spec) for spec in specs]))
    return [*(topic for topic in found if topic.name not in {"/tf", "/tf_static"}), info_of(ROLE)]


def stamp_ns(topic: Topic, message: Any) -> int:
    """The simulated time of a message in ns, to the microsecond; 0 for a message without."""
    stamp = message.clock if topic.name == "/clock" else getattr(getattr(message, "header", None), "stamp", None)
    if stamp is None:
        return int(getattr(message, "frame", 0))
    return round((stamp.sec * 1_000_000_000 + stamp.nanosec) / 1000.0) * 1000


def mount_of(spec: dict[str, Any]) -> Mount:
    """A sensor of ours, by the description that the bridge spawns it from."""
    return Mount(str(spec["id"]), str(spec["type"]), float(spec.get("x", 0.0)), 0.0, float(spec.get("z", 0.0)))


def ego_of(world: carla.World) -> carla.Vehicle:
    """The vehicle that the bridge spawned."""
    until_s = time.monotonic() + LONG_S
    while time.monotonic() < until_s:
        found = [actor for actor in world.get_actors().filter("vehicle.*") if actor.attributes["role_name"] == ROLE]
        if found and len(world.get_actors().filter("sensor.*")) >= len(SENSORS):
            return found[0]
        time.sleep(0.2)
    raise SystemExit("the bridge spawned no vehicle; see its log")


def cpu_s(pid: int) -> float:
    """The processor time that a process has used."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def generated_messages(sources: Path, out: Path) -> Path:
    """Make Python modules of the messages and services that Debian lacks."""
    own = [(name, sources / place / "msg") for name, place in PACKAGES.items()]
    includes = [f"-I{name}:{folder}" for name, folder in own if folder.is_dir()]
    includes += [f"-I{folder.parent.name}:{folder}" for folder in Path("/usr/share").glob("*/msg") if folder.is_dir()]
    for name, place in PACKAGES.items():
        for kind, tool in (("msg", "genmsg_py.py"), ("srv", "gensrv_py.py")):
            files = [file for file in sorted((sources / place / kind).glob(f"*.{kind}")) if file.stem not in UNWANTED]
            if files:
                folder = out / name / kind
                folder.mkdir(parents=True)
                (out / name / "__init__.py").touch()
                command, whither = ["/usr/bin/python3", f"/usr/lib/genpy/{tool}"], ["-p", name, "-o", str(folder)]
                subprocess.run([*command, *map(str, files), *includes, *whither], check=True)
                subprocess.run([*command, "--initpy", *whither], check=True)
    return out


def search_path(sources: Path, site: Path, made: Path) -> str:
    """The PYTHONPATH of the bridge."""
    own = ("carla_ros_bridge", "ros_compatibility", "carla_common", "carla_spawn_objects")
    return os.pathsep.join([str(site), str(made), *(str(sources / "ros-bridge" / name / "src") for name in own)])


def started_server(stack: ExitStack) -> int:
    """Start `linden serve` and return its port."""
    command = [sys.executable, "-m", "linden.cli", "serve", "--port", "0"]
    process = stack.enter_context(subprocess.Popen(command, stdout=subprocess.PIPE, text=True))
    stack.callback(process.terminate)
    assert process.stdout is not None
    for line in process.stdout:
        if (found := READY.search(line)) is not None:
            return int(found[1])
    raise SystemExit("linden serve did not start")


def started_roscore(stack: ExitStack, work: Path) -> dict[str, str]:
    """Start a roscore on a free port and return the environment of its nodes."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    environment = {
        **os.environ,
        "ROS_MASTER_URI": f"http://localhost:{port}",
        "ROS_HOSTNAME": "localhost",
        "ROS_LOG_DIR": str(work / "ros"),
        "ROS_VERSION": "1",
        "ROS_PYTHON_VERSION": "3",
    }
    environment.pop("PYTHONPATH", None)
    core = stack.enter_context(
        subprocess.Popen(["roscore", "-p", str(port)], env=environment, stdout=subprocess.PIPE, text=True)
    )
    stack.callback(core.terminate)
    assert core.stdout is not None
    next((line for line in core.stdout if "started core service" in line), None)
    return environment


def started_bridge(stack: ExitStack, sources: Path, environment: dict[str, str], port: int) -> subprocess.Popen[bytes]:
    """Start the bridge, which makes the world synchronous and ticks it."""
    program = sources / "ros-bridge/carla_ros_bridge/src/carla_ros_bridge/bridge.py"
    options = {
        "_host": "127.0.0.1", "_port": port, "_timeout": 60, "_town": "Linden", "_synchronous_mode": "true",
        "_fixed_delta_seconds": 0.05, "_ego_vehicle_role_name": f'["{ROLE}"]',
    }  # fmt: skip
    words = [f"{name}:={value}" for name, value in options.items()]
    bridge = stack.enter_context(
        subprocess.Popen(["/usr/bin/python3", str(program), "__name:=carla_ros_bridge", *words], env=environment)
    )
    stack.callback(bridge.terminate)
    return bridge


def spawn(
    stack: ExitStack, sources: Path, environment: dict[str, str], specs: list[dict[str, Any]], work: Path
) -> None:
    """Let the bridge's own program spawn vehicle and sensors."""
    sensors = []
    for spec in specs:
        others = {name: value for name, value in spec.items() if name not in {"x", "z"}}
        place = {"x": spec.get("x", 0.0), "y": 0.0, "z": spec.get("z", 0.0), "roll": 0.0, "pitch": 0.0, "yaw": 0.0}
        sensors.append({**others, "spawn_point": place})
    own = {"odom": "odometry", "tf": "tf", "objects": "objects", "speedometer": "speedometer"}
    sensors += [{"type": f"sensor.pseudo.{kind}", "id": name} for kind, name in own.items()]
    vehicle = {"type": "vehicle.tesla.model3", "id": ROLE, "sensors": sensors}
    pseudo = [{"type": f"sensor.pseudo.{kind}", "id": kind} for kind in PSEUDO]
    file = work / "objects.json"
    file.write_text(json.dumps({"objects": [*pseudo, vehicle]}), encoding="utf-8")
    program = sources / "ros-bridge/carla_spawn_objects/src/carla_spawn_objects/carla_spawn_objects.py"
    words = [f"_objects_definition_file:={file}", "_spawn_sensors_only:=false", f"_spawn_point_{ROLE}:="]
    process = stack.enter_context(
        subprocess.Popen(["/usr/bin/python3", str(program), "__name:=carla_spawn_objects", *words], env=environment)
    )
    stack.callback(process.terminate)


if __name__ == "__main__":
    sys.exit(main())
