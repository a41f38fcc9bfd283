"""What a request of AlpaSim's protocol costs: round trips of observations and answer, by policy and by cameras.

    python benchmarks/egodriver.py [--requests 200]

No simulator: the observations are made of a vehicle on a straight route, as the agent ``egodriver`` makes them every
0.1 s of simulated time. The policies run in a process of their own, over TCP on this machine. The policy that stands is
the limit: it does nothing but answer. Medians of milliseconds; CPU is the client's own.
"""

import argparse
import multiprocessing
import statistics
import time
import uuid
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from typing import TypeVar

import numpy as np
from carla_driver_interface.driver import BaseDriver, DriveContext, DriveResult
from carla_driver_interface.geometry import Pose, Trajectory
from carla_driver_interface.policies import RouteFollowerPolicy
from carla_driver_interface.protocol import DriveRequest
from carla_driver_interface.server import serving

from basu.agents.builtin.scene import VehicleGeometry
from basu.agents.sensor_file import parse_sensors
from basu.records.motion import VehicleMotion
from basu.routing import Route
from basu_alpasim import observations, plan
from basu_alpasim.basic_policy import BasicPolicy, Known, sent_route
from basu_alpasim.frames import OriginPose, rig_pose
from basu_alpasim.policy_client import Call, PolicyClient

T = TypeVar("T")
AXLE_M, SPEED_MPS, STEP_US = 1.44, 8.0, 50_000
CAMERAS = {"none": (), "512 x 320": ((512, 320),), "1920 x 1080": ((1920, 1080),)}


class Standing(BaseDriver):
    """The limit."""

    name = "standing"

    def drive(self, ctx: DriveContext) -> DriveResult:
        return DriveResult(trajectory_in_rig=Trajectory([ctx.time_now_us + 1_000_000], [Pose.identity()]))


def basic() -> BaseDriver:
    return BasicPolicy(Known(VehicleGeometry(2.87, AXLE_M, 2.4, 2.4, 1.08), None, SPEED_MPS))


POLICIES = {"standing": Standing, "route_follower": RouteFollowerPolicy, "basic": basic}


def serve(policy: str, port: Connection) -> None:
    with serving(POLICIES[policy](), port=0, host="127.0.0.1") as bound:
        port.send(bound)
        port.recv()


@contextmanager
def served(policy: str) -> Iterator[str]:
    with process_of(policy) as (address, _):
        yield address


@contextmanager
def process_of(policy: str) -> Iterator[tuple[str, int]]:
    ours, theirs = multiprocessing.get_context("spawn").Pipe()
    process = multiprocessing.get_context("spawn").Process(target=serve, args=(policy, theirs), daemon=True)
    process.start()
    yield f"127.0.0.1:{ours.recv()}", process.pid
    ours.send(None)
    process.join()


def measured(address: str, sizes: tuple[tuple[int, int], ...], requests: int) -> tuple[float, float, float, float]:
    """Medians of ms: to make and send the observations, to get the answer, to read it; and CPU of all."""
    route = straight_route()
    entries = [
        {"type": "sensor.camera.rgb", "id": f"camera_{width}", "x": 1.0, "z": 1.5, "width": width, "height": height}
        for width, height in sizes
    ]
    specs = parse_sensors(entries, "the benchmark")
    noise = np.random.default_rng(0)
    pictures = [noise.integers(0, 255, (height // 8, width // 8, 4), np.uint8) for width, height in sizes]
    pictures = [each.repeat(8, axis=0).repeat(8, axis=1) for each in pictures]
    client, session = PolicyClient(address), str(uuid.uuid4())
    client.await_ready(20.0)
    client.start(observations.session_request(session, specs, AXLE_M, client.revision), 0)
    told, answered, read, used = [], [], [], []
    for number in range(requests):
        now_us = 2 * number * STEP_US
        along = [(time_us, moving(time_us)) for time_us in (max(now_us - STEP_US, 0), now_us)][number == 0 :]
        began_s, began_cpu_s = time.perf_counter(), time.process_time()
        rig = rig_pose(along[-1][1], AXLE_M)
        calls = [
            Call("submit_egomotion_observation", observations.egomotion(session, along, AXLE_M)),
            Call("submit_route", observations.route_ahead(session, now_us, route, float(rig.position[0]), rig)),
        ]
        for spec, picture in zip(specs, pictures, strict=True):
            image = observations.image_observation(session, spec.id, now_us, picture)
            calls.append(Call("submit_image_observation", image))
        client.call(calls, now_us)
        told_s = time.perf_counter()
        drive = DriveRequest(session_uuid=session, time_now_us=now_us, time_query_us=now_us + 2 * STEP_US)
        response = client.call([Call("drive", drive)], now_us)[0]
        answered_s = time.perf_counter()
        here = OriginPose(along[-1][1].x_m, 0.0, 0.0)
        plan.Trajectory(plan.read_plan(response, now_us, AXLE_M), now_us, here)
        read_s = time.perf_counter()
        told.append(told_s - began_s)
        answered.append(answered_s - told_s)
        read.append(read_s - answered_s)
        used.append(time.process_time() - began_cpu_s)
    client.close()
    return tuple(1e3 * statistics.median(times_s) for times_s in (told, answered, read, used))


def tick_cost(policy: str, ticks: int, measure: Callable[[Callable[[int], None], int, int], T]) -> T:
    """What ``measure`` says of requests without cameras; it is given the request, their number and the process id."""
    with process_of(policy) as (address, pid):
        route = straight_route()
        client, session = PolicyClient(address), str(uuid.uuid4())
        client.await_ready(20.0)
        client.start(observations.session_request(session, (), AXLE_M, client.revision), 0)

        def request(number: int) -> None:
            now_us = 2 * number * STEP_US
            along = [(time_us, moving(time_us)) for time_us in (max(now_us - STEP_US, 0), now_us)][number == 0 :]
            rig = rig_pose(along[-1][1], AXLE_M)
            ahead = observations.route_ahead(session, now_us, route, float(rig.position[0]), rig)
            motion = Call("submit_egomotion_observation", observations.egomotion(session, along, AXLE_M))
            client.call([motion, Call("submit_route", ahead)], now_us)
            drive = DriveRequest(session_uuid=session, time_now_us=now_us, time_query_us=now_us + 2 * STEP_US)
            response = client.call([Call("drive", drive)], now_us)[0]
            plan.Trajectory(plan.read_plan(response, now_us, AXLE_M), now_us, OriginPose(along[-1][1].x_m, 0.0, 0.0))

        try:
            return measure(request, ticks, pid)
        finally:
            client.close()


def straight_route() -> Route:
    points_m = np.column_stack([np.arange(0.0, 2000.0), np.zeros(2000), np.zeros(2000)])
    route = sent_route(Pose.identity(), points_m)
    assert route is not None
    return route


def moving(time_us: int) -> VehicleMotion:
    values = dict.fromkeys(VehicleMotion._fields, 0.0)
    return VehicleMotion(**(values | {"x_m": AXLE_M + SPEED_MPS * time_us * 1e-6, "velocity_x_mps": SPEED_MPS}))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--requests", type=int, default=200)
    arguments = parser.parse_args()
    print(f"{'policy':16}{'camera':14}{'observe':>9}{'drive':>9}{'read':>9}{'sum':>9}{'CPU':>9}   ms a request")
    for policy in POLICIES:
        with served(policy) as address:
            for name, sizes in CAMERAS.items():
                told, answered, read, used = measured(address, sizes, arguments.requests)
                row = (told, answered, read, told + answered + read, used)
                print(f"{policy:16}{name:14}" + "".join(f"{each:9.2f}" for each in row))


if __name__ == "__main__":
    main()
