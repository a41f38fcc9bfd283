"""``Context``: the state that RPC handlers use, such as world, maps and streams, and the outbox of messages."""

import logging
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import NamedTuple, Protocol

from linden.maps.library import MapLibrary
from linden.maps.navigation.library import MeshLibrary
from linden.protocol.wire.rpc import Packed
from linden.protocol.wire.stream import WORLD_OBSERVER_ID, StreamTable
from linden.replay.file.folder import RecordingFolder
from linden.sensors.runtime.measure import Measurement
from linden.server.rpc.warning_log import WarningLog
from linden.simulation.actor_table import ActorRecord
from linden.world import World

log = logging.getLogger("linden")


class Frames(Protocol):
    """What one frame looks like on the wire: :mod:`linden.server.frames`."""

    def world_payload(self, simulation: World) -> bytes:
        """Return the world snapshot: headers and one row for each actor."""
        ...

    def sensor_payloads(self, simulation: World, measured: Sequence[Measurement]) -> Sequence[tuple[int, bytes]]:
        """Return measurements of this frame as bytes, by stream."""
        ...


class Follower(NamedTuple):
    """A plugin of the server that follows its frames, such as a window or a publisher."""

    name: str
    """As the log calls it."""
    after_frame: Callable[[Sequence[Measurement]], None]
    """Called after each frame with what sensors measured in it."""
    before_frame: Callable[[], None] | None = None
    """Called before each frame."""


class SensorPublisher(Protocol):
    """What publishes measurements on ROS 2: ``linden_ros2.publisher``."""

    streams: set[int]
    """Streams of sensors that are measured in each frame even without subscribers."""

    def enable(self, sensor: ActorRecord) -> None:
        """Publish a sensor also without subscribers.

        Raises:
            Refusal: it has no topic.
        """
        ...


class PendingLoad(NamedTuple):
    """An episode that begins with the next call or frame, once the client that loads it knows the present one."""

    begin: Callable[[], None]
    client: int
    """Number of the connection that loads."""


@dataclass(slots=True)
class Context:
    """One server's state as its handlers see it."""

    world: World
    maps: MapLibrary
    frames: Frames
    streams: StreamTable
    variable_step_s: Callable[[], float]
    meshes: MeshLibrary = field(default_factory=MeshLibrary)
    recordings: RecordingFolder = field(default_factory=RecordingFolder)
    outbox: list[tuple[int, bytes]] = field(default_factory=list)
    """(stream id, message) in the order of sending; the server empties it after every call."""
    caller: int = 0
    """Number of the connection that sent the current call."""
    traffic_managers: dict[int, tuple[str, int]] = field(default_factory=dict)
    """Port -> address of the client that runs a Traffic Manager there, and that client's connection."""
    pending_load: PendingLoad | None = None
    """The load that has been answered and has not begun; see ``rpc.session.load_new_episode``."""
    unshown_load: int | None = None
    """Connection of the client that loads, until the first frame of the new episode."""
    lamps: tuple[list[tuple[int, int]], Packed] | None = None
    """The lamps of all vehicles as they were packed last."""
    frame_is_due: bool = False
    """Whether asynchronous mode's next frame shall not wait for the clock."""
    followers: list[Follower] = field(default_factory=list)
    """A follower that raises an error follows no more; the error is logged."""
    publisher: SensorPublisher | None = None
    """Of a server that was started with ``--ros2``."""
    warnings: WarningLog = field(default_factory=WarningLog)
    bugs: WarningLog = field(default_factory=WarningLog)

    def advance(self) -> int:
        """Make one frame, put what it shows into the outbox, and return its number."""
        for follower in tuple(self.followers):
            if follower.before_frame is not None:
                self._call(follower, follower.before_frame)
        fixed_s = self.world.settings.fixed_delta_seconds
        self.world.step(self.variable_step_s() if fixed_s is None else fixed_s)
        self.unshown_load = None
        listened = self.streams.listened()
        if WORLD_OBSERVER_ID in listened:
            self.outbox.append((WORLD_OBSERVER_ID, self.frames.world_payload(self.world)))
        measured: Sequence[Measurement]
        if self.publisher is not None:
            measured = self.world.measure(listened | self.publisher.streams)
            sent = [each for each in measured if each.sensor.stream_id in listened]
        else:
            measured = sent = self.world.measure(listened)
        self.outbox.extend(self.frames.sensor_payloads(self.world, sent))
        for follower in tuple(self.followers):
            self._call(follower, partial(follower.after_frame, measured))
        return self.world.frame

    def _call(self, follower: Follower, work: Callable[[], None]) -> None:
        """Let a follower do its part of a frame."""
        try:
            work()
        except Exception as error:  # noqa: BLE001 - a bug of a plugin must not end the sessions of clients
            self.drop(follower, error)

    def drop(self, follower: Follower, error: Exception) -> None:
        """Go on without a follower that has raised an error; nothing happens if that is so already."""
        if follower in self.followers:
            self.followers.remove(follower)
            self.log_bug(f"internal error in the {follower.name}; the server goes on without it.", error)

    def begin_pending_load(self) -> None:
        """Begin the episode that a load has been answered for, if there is one."""
        pending, self.pending_load = self.pending_load, None
        if pending is not None:
            pending.begin()
            self.unshown_load, self.frame_is_due = pending.client, True

    def builds_the_scene(self) -> bool:
        """Whether what sensors look at is being built."""
        return not self.world.sensor_scene.wait(0.0)

    def waits_for_the_scene(self) -> bool:
        """Return whether the next frame has to wait for the sensor scene, because a subscriber needs it."""
        if not self.builds_the_scene():
            return False
        world = self.world
        listened = self.streams.listened()
        if self.publisher is not None:
            listened |= self.publisher.streams
        return world.sensors.any_looking(world.episode.actors, listened)

    def warn_once(self, sentence: str) -> None:
        """Log what a client cannot be told, such as why an asynchronous call had no effect; the same only once."""
        self.warnings.say(sentence)

    def log_bug(self, sentence: str, error: BaseException | None = None) -> None:
        """Log a bug of ours with its traceback; however many warnings clients have called forth, it is seen.

        Where memory does not suffice for the traceback, the log has none.
        """
        try:
            trace = "" if error is None else " " + "".join(traceback.format_exception(error))
            self.bugs.say(sentence + trace)
        except MemoryError:
            log.warning("a bug of the server; there is not enough memory for its traceback")
