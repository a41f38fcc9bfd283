"""The set on which the members are called: an episode of the Linden map with one of everything, and the wiretap."""

import queue
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import carla

from every_method.wiretap import RemoteCall, Wiretap

TIMEOUT_S = 60.0
"""A machine that does much else takes its time over a new world."""
EVENT_LIMIT_TICKS = 40


class Stage:
    """A world in synchronous mode, and who stands in it; actors are made when first asked for, unrecorded."""

    def __init__(self, tap: Wiretap) -> None:
        self.tap = tap
        self._hidden: list[tuple[int, int]] = []
        self._forgotten: frozenset[str] = frozenset()
        self._background: set[str] = set()
        self._made: dict[str, Any] = {}
        self.client = carla.Client("127.0.0.1", tap.port())
        self.client.set_timeout(TIMEOUT_S)
        self.world: carla.World = self.client.load_world("Linden")
        settings = self.world.get_settings()
        settings.synchronous_mode = True
        settings.fixed_delta_seconds = 0.05
        self.world.apply_settings(settings)
        self.folder = Path(tempfile.mkdtemp(prefix="linden-every-method-"))
        self.tick(3)

    def barrier(self) -> int:
        """Return the wiretap's position once all that has been called until now has been answered."""
        before = self.tap.position()
        self.client.get_server_version()  # answered after all that was called before on this connection
        after = self.tap.position()
        own = [before + at for at, call in enumerate(self.tap.calls(before, after)) if call.function == "version"]
        self._hidden.append((own[-1], own[-1] + 1))
        return after

    @contextmanager
    def aside(self) -> Iterator[None]:
        """Leave what is called inside out of the record."""
        begin = self.barrier()
        yield
        self._hidden.append((begin, self.barrier()))

    def forget(self, *functions: str) -> None:
        """Leave functions out of this member's record: what a thread of the client calls when it likes."""
        self._forgotten = frozenset(functions)

    def forget_from_now_on(self, *functions: str) -> None:
        """Leave functions out of every later member's record, for the same reason."""
        self._background.update(functions)

    def recorded(self, begin: int, end: int) -> tuple[list[RemoteCall], list[tuple[RemoteCall, str]]]:
        """Return the calls, and the refused ones with their sentences, that were not aside."""
        calls: list[RemoteCall] = []
        refusals: list[tuple[RemoteCall, str]] = []
        for at in range(begin, end):
            if not any(first <= at < last for first, last in self._hidden):
                calls += self.tap.calls(at, at + 1)
                refusals += self.tap.refusals(at, at + 1)
        calls = [call for call in calls if call.function not in self._forgotten | self._background]
        self._forgotten = frozenset()
        return calls, refusals

    def tick(self, frames: int = 1) -> None:
        """Let frames pass, unrecorded."""
        with self.aside():
            for _ in range(frames):
                self.world.tick()

    def pass_frame(self) -> None:
        """Let a frame pass in which the client sends what it has kept back; the tick itself goes unrecorded."""
        begin = self.barrier()
        self.world.tick()
        end = self.barrier()
        for at in range(begin, end):
            if self.tap.calls(at, at + 1)[0].function == "tick_cue":
                self._hidden.append((at, at + 1))

    def once(self, name: str, make: Callable[[], Any]) -> Any:
        """Return what ``make`` makes when it is first asked for, unrecorded."""
        if name not in self._made:
            with self.aside():
                self._made[name] = make()
        return self._made[name]

    def spawn(self, blueprint_id: str, spawn_point: int = 0, **attributes: str) -> carla.Actor:
        """Spawn somebody at one of the map's spawn points, unrecorded, and let a frame pass."""
        with self.aside():
            blueprint = self.world.get_blueprint_library().find(blueprint_id)
            for name, value in attributes.items():
                blueprint.set_attribute(name, value)
            actor = self.world.spawn_actor(blueprint, self.map.get_spawn_points()[spawn_point])
            self.world.tick()
        return actor

    @property
    def map(self) -> carla.Map:
        """The map; the client fetches it the first two times it is asked, so it is asked twice."""
        return self.once("map", lambda: [self.world.get_map() for _ in range(2)][-1])

    @property
    def vehicle(self) -> carla.Vehicle:
        """A car with doors and lamps, standing at the first spawn point."""
        return self.once("vehicle", lambda: self.spawn("vehicle.lincoln.mkz_2020", 0, role_name="hero"))

    @property
    def walker(self) -> carla.Walker:
        """A pedestrian."""
        return self.once("walker", lambda: self.spawn("walker.pedestrian.0001", 2))

    @property
    def light(self) -> carla.TrafficLight:
        """One of the map's traffic lights."""
        return self.once("light", lambda: self.world.get_actors().filter("traffic.traffic_light")[0])

    @property
    def waypoint(self) -> carla.Waypoint:
        """The lane under the vehicle's spawn point."""
        return self.once("waypoint", lambda: self.map.get_waypoint(self.map.get_spawn_points()[0].location))

    def sensor(self, blueprint_id: str, parent: carla.Actor | None = None, **attributes: str) -> carla.Sensor:
        """A sensor above a parent, the vehicle unless another is named; made anew by every call, unrecorded."""
        with self.aside():
            blueprint = self.world.get_blueprint_library().find(blueprint_id)
            for name, value in attributes.items():
                blueprint.set_attribute(name, value)
            above = carla.Transform(carla.Location(z=2.4))
            return self.world.spawn_actor(blueprint, above, attach_to=parent or self.vehicle)

    def event(self, blueprint_id: str, provoke: Callable[[], None] | None = None, **attributes: str) -> Any:
        """What a sensor has measured; the same event for every later call.

        Args:
            blueprint_id: of the sensor.
            provoke: makes happen what the sensor waits for, once it listens.
            attributes: of the sensor.
        """
        return self.once(f"event of {blueprint_id}", lambda: self._measured(blueprint_id, provoke, attributes))

    def _measured(self, blueprint_id: str, provoke: Callable[[], None] | None, attributes: dict[str, str]) -> Any:
        events: queue.Queue[Any] = queue.Queue()
        sensor = self._made[f"sensor {blueprint_id}"] = self.sensor(blueprint_id, **attributes)
        sensor.listen(events.put)
        if provoke:
            provoke()
        for _ in range(EVENT_LIMIT_TICKS):
            self.world.tick()
            if not events.empty():
                break
        event = events.get(timeout=TIMEOUT_S)
        sensor.stop()
        self.tick(3)
        return event
