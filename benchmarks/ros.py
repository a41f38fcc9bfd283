"""What ROS costs a tick: messages made and serialised, and published over DDS to a subscriber, by kind of sensor.

    ROS_LOCALHOST_ONLY=1 python benchmarks/ros.py [--rounds 100]

The subscriber is a second node of this process, which keeps the last ten messages. Times are medians of processor
time of the publishing thread: on a busy machine they say more than wall time.
"""

from __future__ import annotations

import argparse
import statistics
import time
from types import SimpleNamespace as Measured
from typing import TYPE_CHECKING, Any

import numpy as np

from basu_ros.dds import Ros2Node
from basu_ros.moment import Control, Measurement, Moment, Motion, Vehicle
from basu_ros.topics import moment_messages, vehicle_topics
from linden_ros2.mount import Mount
from linden_ros2.topic import Topic

if TYPE_CHECKING:
    from collections.abc import Callable

MS = 1e3


def picture(width: int, height: int) -> Measured:
    raw = np.random.default_rng(0).integers(0, 29, width * height * 4, dtype=np.uint8)
    return Measured(raw_data=raw.tobytes(), width=width, height=height, fov=90.0)


def things() -> dict[str, list[Measurement]]:
    rng = np.random.default_rng(0)
    still = Measured(x=0.0, y=0.0, z=0.0)
    pose = Measured(rotation=Measured(roll=0.0, pitch=0.0, yaw=0.0))
    made: dict[str, tuple[str, Any]] = {
        "lidar, 60,000 points": ("lidar.ray_cast", Measured(raw_data=rng.random((60_000, 4), np.float32).tobytes())),
        "RGB 1280x720": ("camera.rgb", picture(1280, 720)),
        "depth 1280x720": ("camera.depth", picture(1280, 720)),
        "semantic 1280x720": ("camera.semantic_segmentation", picture(1280, 720)),
        "IMU": ("other.imu", Measured(transform=pose, gyroscope=still, accelerometer=still)),
        "GNSS": ("other.gnss", Measured(latitude=0.0, longitude=0.0, altitude=0.0)),
    }
    found = {name: [Measurement(Mount("S", f"sensor.{kind}"), data)] for name, (kind, data) in made.items()}
    return {"state alone (6 topics)": [], **found}


def median_ms(rounds: int, work: Callable[[], object]) -> float:
    times = []
    for _ in range(rounds):
        began_s = time.thread_time()
        work()
        times.append(time.thread_time() - began_s)
    return MS * statistics.median(times)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=100)
    rounds = parser.parse_args().rounds
    print(f"{'in a tick':<24} {'messages, ms':>12} {'with DDS, ms':>12}")
    for name, measured in things().items():
        vehicle = Vehicle("hero", [mount for mount, _ in measured])
        moment = Moment(1.0, 20, Motion(*([0.0] * 15)), Control(), measured=measured)
        node, other = Ros2Node("basu"), Ros2Node("listener")
        topics: list[Topic] = vehicle_topics(vehicle)
        other.listen(*topics)
        node.announce(*topics)
        for topic in topics:
            node.wait_for_readers(topic, 30.0)

        def made(moment: Moment = moment, vehicle: Vehicle = vehicle, node: Ros2Node = node) -> None:
            for _, content in moment_messages(node.types, vehicle, moment):
                node.types.data(content)

        def published(moment: Moment = moment, vehicle: Vehicle = vehicle, node: Ros2Node = node) -> None:
            node.publish(*moment_messages(node.types, vehicle, moment))

        print(f"{name:<24} {median_ms(rounds, made):>12.2f} {median_ms(rounds, published):>12.2f}")
        node.close()
        other.close()


if __name__ == "__main__":
    main()
