"""What a tick costs with software of another process at the wheel: rclpy, Cyclone DDS and AlpaSim's ``egodriver``.

    ROS_LOCALHOST_ONLY=1 python benchmarks/round_trips.py [--ticks 400]

No simulator: the state of a vehicle without sensors is made and sent as BASU does in each tick, and the answer of the
other process is awaited. For ROS 2 the answer is a control command of real rclpy (of the tests' own environment, made
with ``scripts/setup dev``) or of a second node of Cyclone DDS; for ``egodriver`` it is a trajectory of a policy that
stands and of ``basic``, over gRPC. Wall time is from the first message to the answer, median and 95th percentile. CPU
is processor time of BASU's process and of the other one for each tick, all of their threads.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import statistics
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from basu_ros.dds import Ros2Node
from basu_ros.moment import Control, Moment, Motion, Vehicle
from basu_ros.topics import moment_messages, vehicle_topics
from linden_ros2.topic import Message, Topic, control_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

ROOT = Path(__file__).resolve().parents[1]
WARM_UP = 40  # ticks that are not counted
LONGEST_S = 20.0
ODOMETRY = Topic("/carla/hero/odometry", "nav_msgs/msg/Odometry")
MS = 1e3


class Cost(NamedTuple):
    """The cost of a tick, ms."""

    wall_ms: float
    wall_95_ms: float
    own_cpu_ms: float
    other_cpu_ms: float


def cpu_s(pid: int) -> float:
    """Return the processor time of a process so far, user and system, of all threads."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def measured(tick: Callable[[int], None], ticks: int, pid: int) -> Cost:
    """Measure ticks after a warm-up; ``pid`` is the other process."""
    for number in range(WARM_UP):
        tick(number)
    walls, own_s, other_s = [], time.process_time(), cpu_s(pid)
    for number in range(WARM_UP, WARM_UP + ticks):
        began_s = time.perf_counter()
        tick(number)
        walls.append(MS * (time.perf_counter() - began_s))
    own_ms, other_ms = MS * (time.process_time() - own_s) / ticks, MS * (cpu_s(pid) - other_s) / ticks
    return Cost(statistics.median(walls), statistics.quantiles(walls, n=20)[18], own_ms, other_ms)


def cyclone_peer() -> None:
    """Answer each odometry with a command, as the node of rclpy does."""
    node = Ros2Node("driver")
    commands = control_of("hero")
    node.announce(commands)
    node.listen(ODOMETRY)
    while True:
        if node.wait(ODOMETRY, 1.0):
            for odometry in node.received(ODOMETRY):
                content = node.types.message(commands.type, header=odometry.header, throttle=0.5)
                node.publish(Message(commands, content))


@contextmanager
def rclpy_peer() -> Iterator[int]:
    """Start the tests' node of rclpy, and return its process id."""
    sys.path.insert(0, str(ROOT / "tests"))
    from rclpy_environment import PLACE, SIDE, made_rclpy  # noqa: PLC0415 - of the tests

    environment = {**os.environ, "AMENT_PREFIX_PATH": str(PLACE), "PYTHONPATH": str(PLACE / "messages")}
    process = subprocess.Popen([str(made_rclpy()), str(SIDE / "peer.py"), "drive", "good"], env=environment)
    try:
        yield process.pid
    finally:
        process.terminate()
        process.wait()


@contextmanager
def process_of(target: Callable[..., None], *arguments: object) -> Iterator[int]:
    """Start a process of ours, and return its id."""
    process = multiprocessing.get_context("spawn").Process(target=target, args=arguments, daemon=True)
    process.start()
    assert process.pid is not None
    try:
        yield process.pid
    finally:
        process.terminate()
        process.join()


def ros(pid: int, ticks: int) -> Cost:
    """Measure ticks over DDS: six topics out, a command back."""
    vehicle = Vehicle("hero", [])
    topics, commands, node = vehicle_topics(vehicle), control_of("hero"), Ros2Node("basu")
    node.announce(*topics)
    node.listen(commands)
    node.wait_for_readers(ODOMETRY, LONGEST_S)
    until_s = time.monotonic() + LONGEST_S
    while not node.writers_of(commands) and time.monotonic() < until_s:
        time.sleep(0.05)

    def tick(number: int) -> None:
        moment = Moment(0.05 * number, number, Motion(*([0.0] * 15)), Control())
        node.publish(*moment_messages(node.types, vehicle, moment))
        while True:
            if not node.wait(commands, LONGEST_S):
                raise SystemExit(f"no command came within {LONGEST_S:g} s of tick {number}")
            stamps = [each.header.stamp for each in node.received(commands)]
            if any(abs(stamp.sec + 1e-9 * stamp.nanosec - moment.t_s) < 1e-6 for stamp in stamps):
                return

    try:
        return measured(tick, ticks, pid)
    finally:
        node.close()


def egodriver(policy: str, ticks: int) -> Cost:
    """Measure requests of AlpaSim's protocol without cameras: ego motion and route out, a trajectory back."""
    import egodriver as calls  # noqa: PLC0415 - the benchmark beside this one, which has the policies

    return calls.tick_cost(policy, ticks, measured)


def main() -> None:
    """Print a row for each kind of software."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--ticks", type=int, default=400)
    ticks = parser.parse_args().ticks
    print(f"load {os.getloadavg()[0]:.1f}, {os.cpu_count()} processors, {ticks} ticks after {WARM_UP}")
    print(f"{'at the wheel':<24}{'wall':>8}{'95 %':>8}{'CPU here':>10}{'CPU there':>11}   ms a tick")
    with rclpy_peer() as pid:
        show("rclpy (Fast DDS)", ros(pid, ticks))
    with process_of(cyclone_peer) as pid:
        show("cyclonedds", ros(pid, ticks))
    for policy in ("standing", "basic"):
        show(f"egodriver, {policy}", egodriver(policy, ticks))


def show(name: str, cost: Cost) -> None:
    """Print a row."""
    print(
        f"{name:<24}{cost.wall_ms:>8.2f}{cost.wall_95_ms:>8.2f}{cost.own_cpu_ms:>10.2f}{cost.other_cpu_ms:>11.2f}",
        flush=True,
    )


if __name__ == "__main__":
    main()
