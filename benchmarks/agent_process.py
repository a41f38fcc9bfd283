"""What an agent's own process costs a tick, beside the same agent in the benchmark's process.

    python benchmarks/agent_process.py [--ticks 400] [--rounds 3]

The agent presses the throttle and looks at nothing, so what is measured is the way to it and back. A column is the
time from the end of the tick until the control is there, with all measurements of the frame received: median and
quarters of all ticks, in ms. Rounds alternate, so that neighbours on the machine disturb both alike.
"""

import argparse
import time
from pathlib import Path

import numpy as np

from basu.agents.process.remote_agent import find_agent
from basu.agents.sensor_file import SensorSpec, parse_sensors
from basu.files import find
from basu.managers.agents_manager import AgentsManager
from basu.managers.base_manager import Frame, Run, ego_in
from basu.managers.sensors_manager import SensorsManager
from basu.routing import plan
from basu.routing.route_file import read_routes
from basu.simulator import OwnServer, connect

STEP_S, TIMEOUT_S, WARM_UP_TICKS = 0.05, 60.0, 20


def cameras(count: int) -> tuple[SensorSpec, ...]:
    """Colour cameras of 800 x 600 around the vehicle."""
    entry = {"type": "sensor.camera.rgb", "z": 2.5, "width": 800, "height": 600}
    return parse_sensors([{**entry, "id": f"CAMERA {n}", "yaw": 120.0 * n} for n in range(count)], "benchmark")


def round_ms(run: Run, sensors: int, ticks: int, *, in_process: bool) -> list[float]:
    """The times of one round."""
    agents = AgentsManager(find_agent("forward", in_process=in_process), step_limit_s=10.0, routes=None)
    manager = SensorsManager(cameras(sensors), "benchmark", listener=agents)
    agents.setup(run)
    manager.setup(run)
    times_ms = []
    for tick in range(WARM_UP_TICKS + ticks):
        run.world.tick(TIMEOUT_S)
        began_s = time.perf_counter()
        snapshot = run.world.get_snapshot()
        frame = Frame(tick, snapshot.frame, snapshot, ego_in(snapshot.find(run.vehicle.id)))
        manager.tick(frame)
        agents.perceive(manager.data)
        agents.tick(frame)
        times_ms.append(1e3 * (time.perf_counter() - began_s))
    manager.close()
    agents.close()
    return times_ms[WARM_UP_TICKS:]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ticks", type=int, default=400)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    server = OwnServer()
    try:
        client = connect("127.0.0.1", server.port, TIMEOUT_S)
        world = client.get_world()
        settings = world.get_settings()
        settings.synchronous_mode, settings.fixed_delta_seconds = True, STEP_S
        world.apply_settings(settings)
        carla_map = world.get_map()
        (description, *_) = read_routes(find("routes/linden_short.xml", "route file"))
        route = plan(carla_map, description)
        pose = route.waypoints[0].transform
        pose.location.z += 0.3
        vehicle = world.spawn_actor(world.get_blueprint_library().find("vehicle.tesla.model3"), pose)
        world.tick()
        config = AgentsManager(find_agent("forward", in_process=True), step_limit_s=10.0, routes=None).config
        run = Run(
            client=client,
            world=world,
            carla_map=carla_map,
            vehicle=vehicle,
            route=route,
            config=config,
            step_s=STEP_S,
            seed=0,
            timeout_s=TIMEOUT_S,
            folder=Path(),
            server_address=("127.0.0.1", server.port),
            own_simulator=True,
        )
        print(f"{'cameras':>8}{'in process':>24}{'own process':>24}{'costs':>9}")
        for sensors in (0, 3):
            ticks = options.ticks if sensors == 0 else max(20, options.ticks // 10)
            found: dict[bool, list[float]] = {True: [], False: []}
            for _ in range(options.rounds):
                for in_process in (True, False):
                    found[in_process] += round_ms(run, sensors, ticks, in_process=in_process)
            quarters = {where: np.percentile(times, [25, 50, 75]) for where, times in found.items()}
            texts = [f"{q[1]:6.3f} ({q[0]:.3f} to {q[2]:.3f})" for q in (quarters[True], quarters[False])]
            print(f"{sensors:>8}{texts[0]:>24}{texts[1]:>24}{quarters[False][1] - quarters[True][1]:>9.3f}")
    finally:
        server.end()


if __name__ == "__main__":
    main()
