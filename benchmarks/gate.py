"""What a gate costs a tick, in the server itself and as a relay before it, in each track.

    python benchmarks/gate.py [--ticks 400] [--rounds 3] [--actors 30]

A client ticks, and a second one, an agent's, waits for the snapshot of that frame: directly, through a gate of the
server's, or through ``linden gate``. A row has the time from the tick to the snapshot (median and quarters, ms)
and the processor time of server and relay together (ms a tick). Rounds alternate between the ways. In the track
``objects`` the frame waits for the benchmark's word on what the agent sees. The limit of that way is a message to the
process of the gate and one back, which a row has for each kind of gate.
"""

import argparse
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import carla
import numpy as np

from basu.agents.process.gate import Gate, Gates, Relay
from basu.simulator import OwnServer, connect, linden_command

TIMEOUT_S, WARM_UP_TICKS, NAP_S = 20.0, 40, 0.00005
TRACKS = ("world", "objects", "sensors")
CLOCK_HZ = os.sysconf("SC_CLK_TCK")


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ticks", type=int, default=400)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--actors", type=int, default=30, help="vehicles beside the agent's")
    arguments = parser.parse_args()
    gated, plain = OwnServer(gates=True), OwnServer()  # a server with gates lets no relay in
    relay = Relay([*linden_command(), "gate", "--port", str(plain.port)])
    try:
        clients = {server: connect("127.0.0.1", server.port, TIMEOUT_S) for server in (gated, plain)}
        vehicles = {server: spawned(client, 1 + arguments.actors) for server, client in clients.items()}
        ways = {"no gate": (plain, None), "in the server": (gated, Gates(gated)), "relay": (plain, Gates(relay))}
        rows: dict[tuple[str, str], list[tuple[float, float]]] = {}
        for _ in range(arguments.rounds):
            for name, track in [("no gate", ""), *((name, track) for name in list(ways)[1:] for track in TRACKS)]:
                server, keeper = ways[name]
                client, own = clients[server], vehicles[server]
                with agent_of(client, keeper, track, own, server.port) as (agent, gate):
                    cost = measured(client, agent, gate, own, arguments.ticks, [server, relay])
                rows.setdefault((name, track), []).extend(cost)
            for name, (_, keeper) in list(ways.items())[1:]:
                assert keeper is not None, "the first way has none"
                rows.setdefault((name, "limit"), []).extend(answered(keeper, vehicles[ways[name][0]], arguments.ticks))
        print(f"{'gate':<16}{'track':<10}{'to the snapshot, ms':>24}{'processor, ms a tick':>24}")
        for (name, track), costs in rows.items():
            low, middle, high = np.percentile([1e3 * wall_s for wall_s, _ in costs], [25, 50, 75])
            processor_ms = 1e3 * float(np.mean([cpu_s for _, cpu_s in costs]))
            print(f"{name:<16}{track:<10}{f'{middle:.2f} ({low:.2f} to {high:.2f})':>24}{processor_ms:>24.2f}")
    finally:
        relay.end()
        gated.end()
        plain.end()


def spawned(client: carla.Client, count: int) -> list[carla.Actor]:
    """Return vehicles at the first places of the map, the agent's first."""
    world = client.get_world()
    blueprint = world.get_blueprint_library().find("vehicle.tesla.model3")
    vehicles = [world.spawn_actor(blueprint, place) for place in world.get_map().get_spawn_points()[:count]]
    world.tick()
    return vehicles


@contextmanager
def agent_of(
    client: carla.Client, gates: Gates | None, track: str, vehicles: list[carla.Actor], port: int
) -> Iterator[tuple[carla.World, Gate | None]]:
    """Connect an agent's client through a gate, or directly where there is none."""
    gate = None if gates is None else gates.open(track, vehicles[0].id, [])
    address = ("127.0.0.1", port) if gate is None else gate.address
    frame = client.get_world().tick()
    if gate is not None and track == "objects":
        gate.see(frame, [vehicle.id for vehicle in vehicles[:10]])
    agent = carla.Client(*address)
    agent.set_timeout(TIMEOUT_S)
    yield agent.get_world(), gate if track == "objects" else None
    if gate is not None:
        gate.close()


def answered(gates: Gates, vehicles: list[carla.Actor], count: int) -> list[tuple[float, float]]:
    """Return the wall times of orders to a gate with their answers; their processor time is left out."""
    gate = gates.open("world", vehicles[0].id, [])
    times_s = []
    for _ in range(count):
        began_s = time.perf_counter()
        gate.add_sensors([])
        times_s.append((time.perf_counter() - began_s, 0.0))
    gate.close()
    return times_s


def measured(
    client: carla.Client,
    agent: carla.World,
    gate: Gate | None,
    vehicles: list[carla.Actor],
    ticks: int,
    processes: list[OwnServer | Relay],
) -> list[tuple[float, float]]:
    """Return the wall time to the agent's snapshot and the mean processor time, for each tick."""
    world, seen = client.get_world(), [vehicle.id for vehicle in vehicles[:10]]
    walls_s = []
    before_s = 0.0
    for number in range(WARM_UP_TICKS + ticks):
        if number == WARM_UP_TICKS:
            before_s = processor_s(processes)
        began_s = time.perf_counter()
        frame = world.tick()
        if gate is not None:
            gate.see(frame, seen)
        while agent.get_snapshot().frame < frame:
            time.sleep(NAP_S)
        walls_s.append(time.perf_counter() - began_s)
    mean_s = (processor_s(processes) - before_s) / ticks
    return [(wall_s, mean_s) for wall_s in walls_s[WARM_UP_TICKS:]]


def processor_s(processes: list[OwnServer | Relay]) -> float:
    """Return the processor time of processes so far."""
    return sum(map(_of_process, (process.pid for process in processes if process.pid is not None)))


def _of_process(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text("ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / CLOCK_HZ


if __name__ == "__main__":
    main()
