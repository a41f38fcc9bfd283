"""What a handler may touch: the simulation, the maps, the streams, and what goes out with this call."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from linden.handlers.complaints import Complaints
from linden.navigation.library import MeshLibrary
from linden.recording.folder import RecordingFolder
from linden.simulation import Simulation
from linden.wire.stream import WORLD_OBSERVER_ID, StreamTable
from linden.world.maps import MapLibrary

SCENE_S = 0.8
"""How long a call waits at most for the scene that sensors look at: two may stand in line, the Traffic Manager's behind
the program's own."""
MOMENT_S = 0.1
"""How long a frame of asynchronous mode does, before calls have their turn."""


class Frames(Protocol):
    """What one frame looks like on the wire: :mod:`linden.handlers.frames`."""

    def world_payload(self, simulation: Simulation) -> bytes:
        """Return the world snapshot: headers and one row for each actor."""
        ...

    def sensor_payloads(self, simulation: Simulation, listened: set[int]) -> Sequence[tuple[int, bytes]]:
        """Return what this frame's sensors measured, by stream, for the streams that somebody reads."""
        ...


@dataclass(slots=True)
class Context:
    """One server's state as its handlers see it."""

    simulation: Simulation
    maps: MapLibrary
    frames: Frames
    streams: StreamTable
    variable_step_s: Callable[[], float]
    meshes: MeshLibrary = field(default_factory=MeshLibrary)
    recordings: RecordingFolder = field(default_factory=RecordingFolder)
    outbox: list[tuple[int, bytes]] = field(default_factory=list)
    """(stream id, message) in the order of sending; the server empties it after every call."""
    caller: int = 0
    """Number of the connection whose call is being served."""
    traffic_managers: dict[int, tuple[str, int]] = field(default_factory=dict)
    """Port -> address of the client that runs a Traffic Manager there, and that client's connection."""
    frame_is_due: bool = False
    """Whether asynchronous mode's next frame shall not wait for the clock."""
    complaints: Complaints = field(default_factory=Complaints)
    bugs: Complaints = field(default_factory=Complaints)

    def advance(self) -> int:
        """Make one frame, put what it shows into the outbox, and return its number."""
        fixed_s = self.simulation.settings.fixed_delta_seconds
        self.simulation.step(self.variable_step_s() if fixed_s is None else fixed_s)
        listened = self.streams.listened()
        if WORLD_OBSERVER_ID in listened:
            self.outbox.append((WORLD_OBSERVER_ID, self.frames.world_payload(self.simulation)))
        self.outbox.extend(self.frames.sensor_payloads(self.simulation, listened))
        return self.simulation.frame

    def wait_for_the_scene(self) -> None:
        """Give what sensors look at some time to be built, where it is being built.

        So each of the calls that lead to a first picture waits a little, rather than the tick all the time: CARLA's
        examples give a call two seconds.
        """
        self.simulation.seeing.wait(SCENE_S)

    def waits_for_the_scene(self) -> bool:
        """Whether the next frame would have to wait until what sensors look at is built, after a moment of patience."""
        simulation = self.simulation
        if simulation.seeing.wait(0.0):
            return False
        listened, actors = self.streams.listened(), simulation.episode.actors
        if not any(actors.get(sensor_id).stream_id in listened for sensor_id in simulation.episode.eyes):
            return False
        return not simulation.seeing.wait(MOMENT_S)

    def warn_once(self, sentence: str) -> None:
        """Log what a client cannot be told, such as why an asynchronous call had no effect; the same only once."""
        self.complaints.say(sentence)

    def own_up(self, sentence: str) -> None:
        """Log a bug of ours; however many warnings clients have called forth, it is seen."""
        self.bugs.say(sentence)
