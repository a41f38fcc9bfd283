"""Kernels that are compiled in processes of their own: at a first start, and by ``linden compile``.

numba compiles on one processor. So a first start cuts the work into groups. Two processes compile the parts of the
physics while the server makes the rest of what its first tick needs. A third, of low priority, compiles the kernels of
sensors after the server is ready. The server finds the machine code in numba's cache.
"""

import argparse
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import count
from typing import TYPE_CHECKING

from linden.errors import UserError
from linden.sensors.casting.thread_pool import processors

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from linden.maps.cache import MapCache
    from linden.world import World

NICE = 10
"""Priority of a process that compiles while the server serves."""
PROGRAM = """
import gc, os, sys
from linden.cli.compiling import compile_groups
gc.disable()  # numba's objects stay; the collector would take a tenth of the time
os.nice(int(sys.argv[1]))
compile_groups(sys.argv[2:])
"""


def driving() -> None:
    """Compile what moves vehicles on their wheels."""
    from linden.physics.warming import compile_driving  # noqa: PLC0415 - each process imports what its group needs

    compile_driving()


def contacts() -> None:
    """Compile what finds and parts bodies that overlap."""
    from linden.physics.warming import compile_contacts  # noqa: PLC0415 - as in driving

    compile_contacts()


def rays() -> None:
    """Compile rays: the rays of clients, of lidars and of radars."""
    from linden.scenery.ray_query import warm_up  # noqa: PLC0415 - as in driving
    from linden.sensors.warming import warm_rays  # noqa: PLC0415 - as in driving

    warm_up()
    warm_rays()


def cameras() -> None:
    """Compile what cameras need."""
    from linden.sensors.warming import warm_cameras  # noqa: PLC0415 - as in driving

    warm_cameras()


def scenery() -> None:
    """Make the meshes that sensors see on the default map."""
    from linden.maps.cache import MapCache  # noqa: PLC0415 - as in driving
    from linden.scenery.map_mesh_cache import keep_standing  # noqa: PLC0415 - as in driving

    cache = MapCache.of_user()
    simulation = _home_world(cache)
    keep_standing(simulation.episode.map, simulation.episode.surroundings.scene, cache)


def world() -> None:
    """Compile what a world needs beside the physics, and derive what is kept of the default map."""
    from linden.maps.cache import MapCache  # noqa: PLC0415 - as in driving
    from linden.maps.navigation.library import made  # noqa: PLC0415 - as in driving
    from linden.protocol.wire.packed import warm_up as warm_batches  # noqa: PLC0415 - as in driving
    from linden.server.rpc import registry  # noqa: PLC0415 - as in driving
    from linden.simulation.walkers import obstacles_of  # noqa: PLC0415 - as in driving

    registry.load_handlers()
    cache = MapCache.of_user()
    simulation = _home_world(cache)
    simulation.episode.warm_up()
    warm_batches()
    made(simulation.episode.map, obstacles_of(simulation.episode.map))  # maps of users need its kernels


def _home_world(cache: "MapCache") -> "World":
    """Return a world on the default map."""
    from linden.maps.library import HOME_MAP, MapLibrary  # noqa: PLC0415 - as in driving
    from linden.protocol.values.episode import EpisodeSettings  # noqa: PLC0415 - as in driving
    from linden.world import World  # noqa: PLC0415 - as in driving

    return World(MapLibrary([], cache.read).load(HOME_MAP), EpisodeSettings())


def frame() -> None:
    """Compile the frame of physics from its compiled parts, and note that it is compiled."""
    from linden.maps.cache import MapCache  # noqa: PLC0415 - as in driving
    from linden.physics.warming import warm_up  # noqa: PLC0415 - as in driving
    from linden.sensors.compiling import OF_PHYSICS, note_compiled  # noqa: PLC0415 - as in driving

    warm_up()
    note_compiled(OF_PHYSICS, MapCache.of_user())


def sensors() -> None:
    """Note that the kernels of sensors are compiled; ``rays`` and ``cameras`` have compiled them."""
    from linden.maps.cache import MapCache  # noqa: PLC0415 - as in driving
    from linden.sensors.compiling import compile_once  # noqa: PLC0415 - as in driving

    compile_once(MapCache.of_user())


GROUPS: dict[str, Callable[[], None]] = {
    group.__name__: group for group in (cameras, driving, contacts, world, rays, scenery, frame, sensors)
}
"""By name, longest first; ``_LAST`` come after all others."""
_LAST = ("scenery", "frame", "sensors")

PLUGINS = "linden.kernels"
"""Entry points of installed distributions: functions that compile a group more. They come after ``GROUPS``."""


class Compiling:
    """A process that compiles groups of kernels one after the other."""

    def __init__(self, *groups: str, background: bool = False) -> None:
        """Start it; in the background it leaves the processors to others."""
        nice = str(NICE if background else 0)
        self._process = subprocess.Popen(  # noqa: S603 - this very Python
            [sys.executable, "-c", PROGRAM, nice, *groups], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE
        )
        self._compiled = {group: threading.Event() for group in groups}
        threading.Thread(target=self._follow, name="compiling", daemon=True).start()

    def wait(self) -> int:
        """Return the exit code, once it has ended."""
        return self._process.wait()

    def has(self, group: str) -> bool:
        """Return whether a group is compiled, was before, or will not be."""
        return group not in self._compiled or self._compiled[group].is_set()

    def wait_for(self, group: str) -> None:
        """Wait until a group is compiled, or will not be."""
        if group in self._compiled:
            self._compiled[group].wait()

    def end(self) -> None:
        """End it; what it has compiled stays."""
        self._process.terminate()
        self._process.wait()

    def _follow(self) -> None:
        """Note the groups that the process names when they are compiled; at its end, all."""
        assert self._process.stdout is not None
        with self._process.stdout as named:
            for line in named:
                if (group := self._compiled.get(line.decode(errors="replace").strip())) is not None:
                    group.set()
        for group in self._compiled.values():
            group.set()


class FirstStart:
    """What a server compiles before it is ready, and after; where all is compiled, it only loads the physics."""

    STEPS = 5
    """Of what is printed before the server is ready."""

    def __init__(self, say: Callable[[str], None]) -> None:
        """Start nothing yet; ``say`` prints a line."""
        self._say = say
        self._numbers = count(1)
        self._parts: dict[str, Compiling] = {}
        self._frame: Compiling | None = None
        self._background: Compiling | None = None
        self._ending, self._ended = threading.Lock(), False

    def begin(self, cache: "MapCache") -> None:
        """Begin to compile the parts of the physics, where they are not compiled."""
        from linden.sensors.compiling import OF_PHYSICS, is_compiled  # noqa: PLC0415 - as in driving

        self._cache = cache
        if not is_compiled(OF_PHYSICS, cache):
            self._say("linden: compiling kernels, once on this machine: about half a minute on two processors")
            self._parts = {"vehicles": Compiling("driving"), "contacts": Compiling("contacts")}
            self._assembling = threading.Thread(target=self._assemble, name="compiling", daemon=True)
            self._assembling.start()

    def _assemble(self) -> None:
        """Compile the frame of physics as soon as its parts are, beside what the server does."""
        for part in tuple(self._parts.values()):
            part.wait()
        with self._ending:
            if not self._ended:
                self._frame = Compiling("frame")

    def step(self, name: str) -> None:
        """Print that a step is done, where any is to be done."""
        if self._parts:
            self._say(f"linden: compiling kernels, {next(self._numbers)} of {self.STEPS}: {name}")

    def finish_physics(self) -> None:
        """Wait until the frame of physics is compiled, and load it."""
        from linden.physics.warming import warm_up  # noqa: PLC0415 - as in driving
        from linden.sensors.compiling import OF_PHYSICS, note_compiled  # noqa: PLC0415 - as in driving

        for name, part in self._parts.items():
            part.wait()
            self.step(name)
        if self._parts:
            self._assembling.join()
        if self._frame is not None:
            self._frame.wait()
        warm_up()  # what a process could not compile is compiled here
        if self._parts:
            note_compiled(OF_PHYSICS, self._cache)
            self.step("a frame")

    def compile_sensors(self, *, scenery: bool) -> None:
        """Begin to compile what sensors need, in the background, and to make the scenery where that is wanted."""
        from linden.scenery.ray_query import warm_up  # noqa: PLC0415 - as in driving
        from linden.sensors.compiling import OF_SENSORS, is_compiled  # noqa: PLC0415 - as in driving

        groups = ["scenery"] if scenery else []
        if is_compiled(OF_SENSORS, self._cache):
            warm_up()
        else:
            groups = ["rays", *groups, "cameras", "sensors"]
        if groups:
            self._background = Compiling(*groups, background=True)

    def await_sensors(self, pictures: bool) -> None:  # noqa: FBT001 - as SensorScene calls it
        """Wait until the kernels of rays, or of pictures, are compiled; any thread may call it."""
        if self._background is not None:
            self._background.wait_for("cameras" if pictures else "rays")

    def is_compiling(self) -> bool:
        """Return whether kernels of pictures are still being compiled."""
        return self._background is not None and not self._background.has("cameras")

    def end(self) -> None:
        """End what is still compiling; a later start goes on with it."""
        with self._ending:
            self._ended = True
        for process in (*self._parts.values(), self._frame, self._background):
            if process is not None:
                process.end()


def compile_groups(names: Sequence[str]) -> None:
    """Compile groups one after the other, and print the name of each when it is."""
    for name in names:
        (GROUPS.get(name) or _of_plugins()[name].load())()
        print(name, flush=True)  # noqa: T201 - read by Compiling


def _of_plugins() -> "dict[str, EntryPoint]":
    """Return the groups of plugins by name."""
    from importlib.metadata import entry_points  # noqa: PLC0415 - 20 ms that a server starts without

    return {each.name: each for each in entry_points(group=PLUGINS)}


def add_parser(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command ``compile``."""
    whole = commands.add_parser(
        "compile",
        help="compile all kernels now, such as when an image is built",
        description="Compile all kernels, so that the first start need not; on all processors.",
    )
    whole.set_defaults(command=run)


def run(_arguments: argparse.Namespace) -> int:
    """Compile all groups, as many at a time as there are processors.

    Raises:
        UserError: a group could not be compiled.
    """
    together = [name for name in GROUPS if name not in _LAST]
    of_plugins = list(_of_plugins())
    groups, numbers = len(GROUPS) + len(of_plugins), count(1)

    def compiled(name: str) -> tuple[str, int]:
        ended = name, Compiling(name).wait()
        if not ended[1]:
            print(f"linden: compiled kernels, group {next(numbers)} of {groups}: {name}", flush=True)  # noqa: T201 - as in serve
        return ended

    with ThreadPoolExecutor(processors()) as workers:
        ended = list(workers.map(compiled, together))
        for names in (_LAST, of_plugins):
            ended += workers.map(compiled, names)
    failed = [name for name, code in ended if code]
    if failed:
        raise UserError(f"could not compile {', '.join(failed)}; the messages stand above")
    return 0
