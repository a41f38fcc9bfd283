"""`play`: replays a recorder file in real time on a running simulator, or on one that it starts."""

from __future__ import annotations

import contextlib
import time
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.episode.world import ticked_by_us
from basu.errors import SimulatorError, UserError
from basu.simulator import OwnServer, connect

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    import carla

    from basu_carla_log import Log


NO_ACTOR = 0  # followed by the spectator where there is no hero


class Where(NamedTuple):
    """A simulator to play on: ``host`` None starts one of our own."""

    host: str | None
    port: int
    timeout_s: float


class Progress(NamedTuple):
    """Callbacks while it plays."""

    ready: Callable[[str], object]  # the address at which the simulator can be watched
    frame: Callable[[int], object]  # so many frames more were shown


def play(log: Log, where: Where, *, speed: float, progress: Progress) -> None:
    """Play a recording from its first frame to its last, the spectator behind the hero.

    ``speed`` is simulated against wall time, 0 for as fast as it goes.

    Raises:
        UserError: no server answers there, or the simulator cannot replay the file.
        SimulatorError: it went away.
    """
    with simulator_for(log.path, where) as (client, address):
        step_s = float(np.median(np.diff(log.elapsed_s))) if log.frames > 1 else 0.05
        hero = next(iter(log.ids_of(role_name="hero")), NO_ACTOR)
        with ticked_by_us(client.get_world(), step_s):  # a replay goes on by itself where no client holds the clock
            world = begin_replay(client, log, hero)
            progress.ready(address)
            with ticked_by_us(world, step_s):  # again: another map comes with settings of its own
                _go_on(world, log.frames, step_s, speed, where.timeout_s, progress.frame)
            with contextlib.suppress(RuntimeError):  # the simulator is gone, and the replay with it
                client.stop_replayer(False)


@contextlib.contextmanager
def simulator_for(log: Path, where: Where) -> Iterator[tuple[carla.Client, str]]:
    """Yield the simulator that can read a recorder file, and its address.

    Raises:
        UserError: no server answers there.
    """
    if where.host is not None:
        yield connect(where.host, where.port, where.timeout_s), f"{where.host}:{where.port}"
        return
    server = OwnServer(recordings=log.resolve().parent)
    try:
        yield connect("127.0.0.1", server.port, where.timeout_s), f"127.0.0.1:{server.port}"
    finally:
        server.end()


def begin_replay(client: carla.Client, log: Log, hero: int) -> carla.World:
    """Begin a replay and return its world; the spectator follows the actor ``hero``.

    Raises:
        UserError: the simulator cannot replay the file.
    """
    try:
        client.replay_file(str(log.path.resolve()), 0.0, 0.0, hero)
        world = client.get_world()
        lies_in, is_in = (name.rsplit("/", maxsplit=1)[-1] for name in (log.map_name, world.get_map().name))
    except RuntimeError as error:
        raise UserError(f"the simulator cannot replay {log.path}: {error}") from error
    if lies_in != is_in:  # CARLA says so in a text, and goes on in the map that is there
        raise UserError(
            f"the simulator has no map {lies_in}, in which {log.path} lies; with --host name one that has it, such as "
            "a `linden serve --maps DIR --recordings DIR` of your own"
        )
    return world


def _go_on(
    world: carla.World, frames: int, step_s: float, speed: float, timeout_s: float, shown: Callable[[int], object]
) -> None:
    """Tick as often as there are frames."""
    began_s = time.perf_counter()
    for done in range(1, frames + 1):
        try:
            world.tick(timeout_s)
        except RuntimeError as error:
            raise SimulatorError(f"the simulator went away after {done - 1} of {frames} frames: {error}") from error
        shown(1)
        if speed > 0.0:
            time.sleep(max(0.0, done * step_s / speed - (time.perf_counter() - began_s)))
