"""SUMO beside any client of a simulator: ``basu sumo`` goes on with another program's ticks, or makes them itself."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from basu.episode.world import ticked_by_us
from basu.errors import SimulatorError, UserError
from basu.simulator import connect, linden_command
from basu_sumo.bridge import Bridge
from basu_sumo.link import Link, connected, in_process
from basu_sumo.random_trips import RandomTrips
from basu_sumo.scenario import Wanted, config_in, made_of

if TYPE_CHECKING:
    from collections.abc import Generator

    import carla

    from basu.conditions import Sumo
    from basu.options.run import RunOptions

HOST = "127.0.0.1"
PLACES = 20  # spawn points of the map that a network is tried on
MISFIT_M = 4.0  # from a spawn point to the middle of SUMO's lanes: a lane's width


def cosimulate(options: RunOptions, *, step_s: float, makes_ticks: bool, limit_s: float | None) -> str:
    """Let SUMO and a running simulator go on in step; return a sentence on what was shown.

    SUMO steps whenever another client has ticked, as often as its own step fits into the time that has passed. With
    ``makes_ticks`` the ticks are made here, in synchronous mode. It ends after ``limit_s`` of simulated time, or with
    the user's interruption, and takes everything away that it has spawned.

    Raises:
        UserError: no simulator answers, or SUMO's scenario cannot be used there.
        SimulatorError: SUMO or the simulator failed.
    """
    client = connect(options.host or HOST, options.port, options.timeout_s)
    world = client.get_world()
    sumo = options.sumo_of("", None)
    assert sumo is not None, "the command has set what SUMO is to do"
    carla_map = world.get_map()
    link = _link(sumo, carla_map, options.seed, step_s)
    try:
        bridge = Bridge(link, client, world, carla_map, radius_m=sumo.radius_m, lights=sumo.lights)
        _check(bridge, carla_map)
        if sumo.is_random:
            bridge.before_step = RandomTrips(link, sumo.vehicles, options.seed, bridge.viewers_m, bridge.held).fill
        snapshots = _ticked(world, step_s, options.timeout_s) if makes_ticks else _followed(world, options.timeout_s)
        _go_on(bridge, snapshots, step_s, limit_s)
    except RuntimeError as error:
        raise SimulatorError(f"the simulator failed beside SUMO: {error}") from error
    finally:
        link.close()
    counts = bridge.counts
    return (
        f"SUMO's traffic    {counts.departed} vehicles and {counts.people} people in {link.steps * step_s:.1f} s of "
        f"simulated time; {counts.most} and {counts.most_people} at a time"
    )


def _link(sumo: Sumo, carla_map: carla.Map, seed: int, step_s: float) -> Link:
    """A SUMO with the given scenario; without one, with a scenario made of the simulator's map."""
    if sumo.port is not None:
        return connected(HOST, sumo.port, step_s=step_s)
    config = sumo.file
    if config is None:
        town = carla_map.name.rpartition("/")[2]
        wanted = Wanted() if sumo.hour is None else Wanted(hour=sumo.hour)
        if sumo.scale is not None:
            wanted = wanted._replace(scale=sumo.scale)
        folder = made_of(carla_map.to_opendrive(), town, seed, linden_command(), wanted)
        config = config_in(folder, is_random=sumo.is_random)
    return in_process(config, step_s=step_s, seed=seed)


def _check(bridge: Bridge, carla_map: carla.Map) -> None:
    """Check that SUMO's network is that of the simulator's map.

    Raises:
        UserError: it is another one.
    """
    points = carla_map.get_spawn_points()
    lanes = [carla_map.get_waypoint(point.location) for point in points[:: max(1, len(points) // PLACES)]]
    places = [lane.transform.location for lane in lanes if lane is not None]
    if places and bridge.misfit_m([(place.x, place.y, place.z) for place in places]) > MISFIT_M:
        raise UserError(
            f"SUMO's network is not that of {carla_map.name}: the map's spawn points lie on none of its lanes; "
            "make one with `linden map sumo`"
        )


def _followed(world: carla.World, timeout_s: float) -> Generator[carla.WorldSnapshot, None, None]:
    """Yield each snapshot that another client's tick brings.

    Raises:
        SimulatorError: no client ticks.
    """
    try:
        while True:
            yield world.wait_for_tick(timeout_s)
    except RuntimeError as error:
        raise SimulatorError(
            f"no tick came within {timeout_s:g} s; start the program that ticks first, or add --tick ({error})"
        ) from error


def _ticked(world: carla.World, step_s: float, timeout_s: float) -> Generator[carla.WorldSnapshot, None, None]:
    """Yield the snapshot of each tick that is made here."""
    with ticked_by_us(world, step_s):
        world.tick(timeout_s)
        while True:
            yield world.get_snapshot()
            world.tick(timeout_s)


def _go_on(
    bridge: Bridge, snapshots: Generator[carla.WorldSnapshot, None, None], step_s: float, limit_s: float | None
) -> None:
    """Let SUMO go on for as long as there are snapshots; the user's interruption is a way to end it."""
    began_s, last = None, sys.maxsize if limit_s is None else round(limit_s / step_s)
    try:
        for snapshot in snapshots:
            now_s = snapshot.timestamp.elapsed_seconds
            began_s = now_s - step_s if began_s is None else began_s
            due = min(round((now_s - began_s) / step_s), last) - bridge.link.steps
            bridge.step(snapshot, steps=due)
            if bridge.link.steps >= last:
                break
    except KeyboardInterrupt:
        print("basu: interrupted; SUMO's traffic is taken away", file=sys.stderr)
    finally:
        bridge.close()
        snapshots.close()  # the settings of the world come back
