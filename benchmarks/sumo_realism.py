"""How SUMO's drivers behave beside the Traffic Manager's: headways, stop signs, contacts for each vehicle-hour.

    python benchmarks/sumo_realism.py --folder net/ --vehicles 100 --minutes 10 [--traffic-manager]

``net/`` comes from `linden map sumo Linden -o net/`. One watcher judges both from poses alone (traffic_watch.py). SUMO
runs by itself: what is shown in a simulator are its poses. ``--traffic-manager`` drives as many cars of the official
client's Traffic Manager on a server of our own instead. Each vehicle has a way that is longer than the run.
"""

import argparse
from collections.abc import Iterator
from pathlib import Path

import carla
import numpy as np
from live import LINDEN, STEP_S, Snapshots, free_port, server, synchronous_world
from numpy.typing import NDArray
from traffic import manager, populate
from traffic_watch import F64, Fleet, Signs, Watch, fleet_of, stop_signs

from basu_sumo.frames import from_sumo
from basu_sumo.link import Link, in_process
from basu_sumo.random_trips import RandomTrips
from basu_sumo.scenario import config_in
from linden.protocol.values.enums import TrafficLightState
from linden_maps.sumo.net import Net, read_net

ROW = np.dtype(
    [
        ("id", "<u4"),
        ("location", "<f4", 3),
        ("rotation", "<f4", 3),
        ("traffic_light_state", "<u1"),
        ("has_traffic_light", "<u1"),
    ]
)
WAY_M_PER_S = 16.0  # a way is as long as a car drives at the highest limit of Linden
BEFORE_LINE_M = 3.0  # from a stop line to the middle of a stop sign's trigger volume, as the server has it
AHEAD_M, ASIDE_M, MOVES_MPS, SAME_WAY_DEG = 60.0, 1.5, 3.0, 15.0
"""A vehicle follows another one that is so near ahead in its lane, while it moves."""


def ways(trips: RandomTrips, link: Link, length_m: float) -> Iterator[list[str]]:
    """Yield routes of at least this length: random trips, joined end to beginning."""
    lengths = {}
    while True:
        way: list[str] = []
        driven_m = 0.0
        while driven_m < length_m:
            part = trips._route()  # noqa: SLF001 - the same draw as in a run
            assert part is not None, "nothing sees it"
            if way:
                joined = link.api.simulation.findRoute(way[-1], part[0], "DEFAULT_VEHTYPE").edges
                if not joined:
                    continue
                part = [*joined[1:], *part[1:]]
            for edge in part:
                if edge not in lengths:
                    lengths[edge] = link.api.lane.getLength(f"{edge}_0")
                driven_m += lengths[edge]
            way += part
        yield way


def of_sumo(folder: Path, count: int, minutes: float, seed: int) -> tuple[Watch, F64]:
    link = in_process(config_in(folder, is_random=True), step_s=STEP_S, seed=seed)
    trips = RandomTrips(link, 0, seed)
    api = link.api
    for number, way in zip(range(count), ways(trips, link, minutes * 60.0 * WAY_M_PER_S), strict=False):
        api.route.add(f"way{number}", way)
        api.vehicle.add(f"car{number}", f"way{number}", typeID="traffic", departLane="best", departPos="random_free")
    while api.vehicle.getIDCount() < count and link.steps < 6000:
        link.step()
    names = sorted(api.vehicle.getIDList(), key=lambda name: int(name.removeprefix("car")))
    lengths = [api.vehicle.getLength(name) for name in names]
    widths = [api.vehicle.getWidth(name) for name in names]
    ids = np.array([int(name.removeprefix("car")) for name in names], np.uint32)
    fleet = Fleet(ids, 0.5 * np.column_stack([lengths, widths]), np.zeros(len(names)))
    net = next(folder.glob("*.net.xml"))
    watch, gaps = Watch(fleet, signs_of(read_net(net)), STEP_S), []
    for _ in range(round(minutes * 60.0 / STEP_S)):
        link.step()
        present = set(api.vehicle.getIDList())
        rows = np.zeros(len(names), ROW)
        rows["traffic_light_state"] = TrafficLightState.GREEN
        for row, name, length_m, number in zip(rows, names, lengths, ids, strict=True):
            if name not in present:
                continue
            place, angle = api.vehicle.getPosition3D(name), api.vehicle.getAngle(name)
            pose = from_sumo(place, angle, 0.0, length_m, link.offset_m)
            row["id"], row["location"], row["rotation"] = number, pose[:3], (0.0, pose.yaw_deg, 0.0)
        rows = rows[[name in present for name in names]]
        before_m = watch.place.copy()
        watch.see(rows)
        gaps.append(headways(watch, fleet, before_m, rows))
    link.close()
    return watch, np.concatenate(gaps)


def of_traffic_manager(count: int, minutes: float, seed: int) -> tuple[Watch, F64]:
    with server([*LINDEN]) as live:
        client = carla.Client("127.0.0.1", live.port)
        client.set_timeout(120.0)
        world = synchronous_world(client)
        vehicles = populate(client, world, count, seed)
        leader = manager(client, free_port(), hybrid=False, seed=seed)
        for vehicle in vehicles:
            vehicle.set_autopilot(True, leader.get_port())
        fleet = fleet_of(vehicles)
        watch, gaps = Watch(fleet, stop_signs(world), STEP_S), []
        snapshots = Snapshots(live)
        for _ in range(round(minutes * 60.0 / STEP_S)):
            rows = snapshots.rows_of(world.tick())
            before_m = watch.place.copy()
            watch.see(rows)
            gaps.append(headways(watch, fleet, before_m, watch._in_order(rows)))  # noqa: SLF001 - ours
        return watch, np.concatenate(gaps)


def signs_of(net: Net) -> Signs:
    """The stop signs of a network: where a lane ends at a link that stops."""
    stopping = {(each.start, each.start_lane) for each in net.connections if each.state in "sw"}
    found = []
    for edge, number in sorted(stopping):
        lane = net.edges[edge].lanes[number] if edge in net.edges else None
        if lane is None or not lane.for_cars:
            continue
        (x0_m, y0_m), (x1_m, y1_m) = lane.shape[-2][:2], lane.shape[-1][:2]
        yaw = np.arctan2(-(y1_m - y0_m), x1_m - x0_m)
        x_m, y_m = x1_m - net.offset_m[0], -(y1_m - net.offset_m[1])
        found.append((x_m - BEFORE_LINE_M * np.cos(yaw), y_m - BEFORE_LINE_M * np.sin(yaw), yaw))
    table = np.array(found).reshape(-1, 3)
    return Signs(table[:, :2], table[:, 2])


def headways(watch: Watch, fleet: Fleet, before_m: F64, rows: NDArray[np.void]) -> F64:
    """The time gaps in s of all vehicles that follow another one in this frame, front to rear."""
    if len(rows) != len(fleet.ids):
        return np.empty(0)
    yaw = np.radians(rows["rotation"][:, 1].astype(np.float64))
    middle, moved_m = watch.place[:, :2], np.linalg.norm((watch.place - before_m)[:, :2], axis=1)
    speed_mps = np.nan_to_num(moved_m / STEP_S)
    gap = middle[None, :, :] - middle[:, None, :]
    along = gap[..., 0] * np.cos(yaw)[:, None] + gap[..., 1] * np.sin(yaw)[:, None]
    across = np.abs(gap[..., 1] * np.cos(yaw)[:, None] - gap[..., 0] * np.sin(yaw)[:, None])
    same_way = np.cos(yaw[:, None] - yaw[None, :]) > np.cos(np.radians(SAME_WAY_DEG))
    free_m = along - fleet.half_m[:, None, 0] - fleet.half_m[None, :, 0]
    free_m[~((along > 0.0) & (across < ASIDE_M) & same_way)] = np.inf
    nearest_m = free_m.min(axis=1)
    follows = (nearest_m < AHEAD_M) & (speed_mps > MOVES_MPS)
    return nearest_m[follows] / speed_mps[follows]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path)
    parser.add_argument("--vehicles", type=int, default=100)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--traffic-manager", action="store_true")
    options = parser.parse_args()
    if options.traffic_manager:
        watch, gaps_s = of_traffic_manager(options.vehicles, options.minutes, options.seed)
    else:
        watch, gaps_s = of_sumo(options.folder, options.vehicles, options.minutes, options.seed)
    hours = len(watch.ids) * options.minutes / 60.0
    passes, touched = watch.sign_passes, watch.collisions
    mean_kmh = watch.driven_m.sum() / hours / 1000.0
    print(f"vehicles {len(watch.ids)}, vehicle-hours {hours:.1f}, mean speed {mean_kmh:.1f} km/h")
    print(f"pairs that touched {touched} ({touched / hours:.2f} a vehicle-hour), longer {watch.pile_ups}")
    print(f"stop signs: stood {passes['stood']}, crept {passes['crept']}, passed {passes['passed']}")
    print(f"longest stand {watch.longest_standing_s.max():.0f} s; present at the end {watch.present.sum()}")
    if len(gaps_s):
        quarters = np.percentile(gaps_s, [5, 25, 50, 75])
        print(
            "headway s, 5 25 50 75 %: "
            + " ".join(f"{each:.2f}" for each in quarters)
            + f"; below 1 s {(gaps_s < 1.0).mean():.3f}"
        )


if __name__ == "__main__":
    main()
