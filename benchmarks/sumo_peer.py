"""CARLA's own ``run_synchronization.py`` beside a world, at its best: ``sumo.py --peer`` starts this program.

    python benchmarks/sumo_peer.py DIR CONFIG PORT VEHICLES TICKS

DIR is CARLA's folder ``Co-Simulation/Sumo``. The loop of its script sleeps to the wall clock; here ``tick`` is called
without the sleep. The vehicles are our random trips. ``traci.sumolib`` is set, because today's TraCI has none.
Among the output is one line of JSON: vehicles shown, s of wall time, s of processor time of client and SUMO.
"""

from __future__ import annotations

import importlib
import json
import sys
import time
from pathlib import Path

import psutil
import sumolib
import traci

from basu_sumo.link import Link
from basu_sumo.random_trips import RandomTrips

STEP_S = 0.05
SETTLE_TICKS = 40


def main() -> None:
    folder, config, port, vehicles, ticks = (*map(Path, sys.argv[1:3]), *map(int, sys.argv[3:]))
    sys.path.insert(0, str(folder))
    traci.sumolib = sumolib
    script = importlib.import_module("run_synchronization")
    sumo = script.SumoSimulation(str(config), STEP_S)
    synchronization = script.SimulationSynchronization(sumo, script.CarlaSimulation("127.0.0.1", port, STEP_S))
    trips = RandomTrips(Link(traci, (traci.exceptions.TraCIException,), lambda: None), vehicles, 1)

    def tick() -> None:
        trips.fill()
        synchronization.tick()

    try:
        for _ in range(SETTLE_TICKS):
            tick()
        (engine,) = [child for child in psutil.Process().children() if "sumo" in child.name()]
        began_s, client_s, sumo_s = time.perf_counter(), time.process_time(), sum(engine.cpu_times()[:2])
        for _ in range(ticks):
            tick()
        found = {
            "took_s": time.perf_counter() - began_s,
            "client_s": time.process_time() - client_s + sum(engine.cpu_times()[:2]) - sumo_s,
            "shown": len(synchronization.sumo2carla_ids),
        }
        sys.stdout.write(json.dumps(found) + "\n")
    finally:
        synchronization.close()


if __name__ == "__main__":
    main()
