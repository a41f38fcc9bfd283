"""Records an episode as CARLA's recorder does: added and removed actors, and the state of all actors after each frame.

Rows of the snapshot become records of the file by whole columns. While nothing is recorded, nothing is done.
Source of what is written when: ``CarlaRecorder.cpp``; docs/reference/recorder.md says where this one does more.
"""

import logging
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import numpy as np

from linden.blueprints.library import BlueprintKind
from linden.geometry import compose
from linden.physics.columns import finite
from linden.protocol.values.episode import LightState
from linden.protocol.values.space import Transform, Vector3D
from linden.replay import frame_records as recorded_lamps
from linden.replay import frame_records as rows_of
from linden.replay.file import layouts
from linden.replay.file import write as encode
from linden.replay.file.layouts import PacketId, to_file
from linden.replay.file.packets import ActorAdded, PhysicsRecord
from linden.replay.file.write import RecordingWriter
from linden.replay.frame_records import collisions
from linden.replay.interpolation import FARTHEST_M
from linden.simulation.actor_table import NO_BODY, ActorRecord
from linden.simulation.episode import Episode
from linden.structured import StructuredArray

log = logging.getLogger("linden")

M_TO_CM = 100.0
_SIGNALS = (BlueprintKind.TRAFFIC_LIGHT, BlueprintKind.TRAFFIC_SIGN)
_KINDS_OF_FILE = (
    BlueprintKind.OTHER,
    BlueprintKind.VEHICLE,
    BlueprintKind.WALKER,
    BlueprintKind.TRAFFIC_LIGHT,
    BlueprintKind.TRAFFIC_SIGN,
    BlueprintKind.SENSOR,
)
"""Kinds with their numbers in the file; all other kinds are ``other``."""


class Recorder:
    """What is being recorded, if anything."""

    def __init__(self) -> None:
        self._tape: _Tape | None = None

    @property
    def path(self) -> Path | None:
        """The file that is being written, None while nothing is recorded."""
        return None if self._tape is None else self._tape.writer.path

    def start(
        self, path: Path, episode: Episode, map_name: str, clock: Callable[[], float], *, additional_data: bool
    ) -> None:
        """Record from the next frame on, with all present actors; a recording under way ends.

        Args:
            path: of the file, which is replaced.
            episode: what is recorded.
            map_name: as the file's header has it.
            clock: unix time in s, for the file's date and for its platform times, which nothing depends on.
            additional_data: whether to write velocities, boxes, platform times, physics and times of lights too.

        Raises:
            OSError: the file cannot be written.
        """
        self.stop()
        writer = RecordingWriter(path, map_name, int(clock()))
        self._tape = _Tape(writer, clock, additional_data=additional_data)
        self._tape.before_step(episode)

    def stop(self) -> None:
        """End the recording under way, if there is one."""
        if self._tape is not None:
            self._tape.writer.close()
            self._tape = None

    def before_step(self, episode: Episode) -> None:
        """Note the actors added since the last frame, with their first places."""
        if self._tape is not None:
            self._tape.before_step(episode)

    def physics_changed(self, actor_id: int) -> None:
        """Note that a vehicle is made of something else from now on."""
        if self._tape is not None:
            self._tape.new_physics.append(actor_id)

    def after_step(self, episode: Episode, delta_s: float) -> None:
        """Write the frame. Where the file takes no more, the recording ends, the log says why, and all else goes on."""
        if self._tape is None:
            return
        try:
            self._tape.write(episode, delta_s)
        except OSError as error:
            log.warning(
                "the recording %s ends at %.2f s, after its last whole frame: %s; the simulation goes on",
                self._tape.writer.path,
                self._tape.writer.elapsed_s,
                error.strerror or error,
            )
            self.stop()


class _Tape:
    """A recording under way."""

    def __init__(self, writer: RecordingWriter, clock: Callable[[], float], *, additional_data: bool) -> None:
        self.writer = writer
        self.new_physics: list[int] = []
        self._clock, self._began_s = clock, clock()
        self._additional_data = additional_data
        self._known: dict[int, ActorRecord] = {}
        self._added: list[ActorAdded] = []
        self._seen_version = -1
        self._columns_version = -1
        self._lamps: dict[int, LightState] | None = None
        self._light_times: StructuredArray | None = None
        self._collisions = 0
        self._open_doors: dict[int, frozenset[int]] = {}

    def before_step(self, episode: Episode) -> None:
        if episode.actors.version == self._seen_version:
            return
        self._seen_version = episode.actors.version
        for record in episode.actors:
            if record.id in self._known:
                continue
            self._known[record.id] = record
            self._added.append(_added(record, episode.own_transform(record.id)))

    def write(self, episode: Episode, delta_s: float) -> None:
        self.writer.add(delta_s, list(self._packets(episode)))
        self._added.clear()
        self.new_physics.clear()

    def _packets(self, episode: Episode) -> Iterator[bytes]:
        """Yield the packets of a frame in CARLA's order, then Linden's own."""
        come = [record for actor in self._added if (record := episode.actors.find(actor.id)) is not None]
        gone: list[tuple[int]] = []
        if episode.actors.version != self._columns_version:
            self._columns = rows_of.columns(episode)
            self._columns_version = episode.actors.version
            gone = [(actor_id,) for actor_id in self._known if actor_id not in episode.actors]
            self._known = {record.id: record for record in self._known.values() if record.id in episode.actors}
        rows = episode.actors.rows
        positions = rows_of.positions(rows, self._columns.placed)
        positions["location_cm"], ulps = to_file(rows["location"][self._columns.placed])
        yield encode.seconds(PacketId.VISUAL_TIME, episode.elapsed_s)
        yield encode.added(self._added)
        yield encode.records(PacketId.REMOVED, np.array(gone, layouts.REMOVED))
        yield encode.records(PacketId.PARENTS, _parents(come))
        yield encode.records(PacketId.COLLISIONS, self._contacts(episode))
        yield encode.records(PacketId.DOORS, self._swung_doors(episode))
        yield encode.records(PacketId.POSITIONS, positions)
        yield encode.records(PacketId.LIGHT_STATES, rows_of.light_states(rows, self._columns.lights))
        yield encode.records(PacketId.VEHICLES, rows_of.vehicles(rows, self._columns.vehicles))
        yield encode.records(PacketId.WALKERS, rows_of.walkers(rows, self._columns.walkers))
        yield encode.records(PacketId.VEHICLE_LIGHTS, rows_of.lamps(self._columns.vehicle_records))
        if len(lamps := self._changed_lamps(episode)):
            yield encode.records(PacketId.SCENE_LIGHTS, lamps)
        if wheels := rows_of.wheels(episode, self._columns.vehicle_records):
            yield encode.wheels(wheels)
        if self._additional_data:
            yield from self._additional(episode, come)
        yield encode.packet(PacketId.LOCATION_ULPS, len(ulps).to_bytes(2, "little") + ulps.tobytes())

    def _changed_lamps(self, episode: Episode) -> StructuredArray:
        """Return the lamps of streets and houses that stand otherwise than in the last frame; in the first, all."""
        known = self._lamps
        if known is not None and not episode.surroundings.lamps.pending:
            return recorded_lamps.records([])
        self._lamps = {lamp.id: lamp for lamp in episode.surroundings.lamp_states()}
        return recorded_lamps.records([lamp for lamp in self._lamps.values() if (known or {}).get(lamp.id) != lamp])

    def _swung_doors(self, episode: Episode) -> StructuredArray:
        """Return the doors that were opened or closed since the last frame; in the first, all that are open."""
        before = {actor_id: doors for actor_id, doors in self._open_doors.items() if actor_id in episode.actors}
        self._open_doors = dict(episode.doors.open)
        return rows_of.doors(before, self._open_doors)

    def _contacts(self, episode: Episode) -> StructuredArray:
        if not len(episode.contacts):
            return np.zeros(0, layouts.COLLISION)
        found = collisions(episode, self._collisions)
        self._collisions += len(found)
        return found

    def _additional(self, episode: Episode, come: list[ActorRecord]) -> Iterator[bytes]:
        """Yield the packets of additional data; as in CARLA, lists of nothing are left out."""
        rows, columns = episode.actors.rows, self._columns
        lists = (
            (PacketId.KINEMATICS, rows_of.kinematics(rows, columns.moving)),
            (PacketId.BOXES, _boxes(come)),
            (PacketId.TRIGGER_VOLUMES, _trigger_volumes(episode, come)),
        )
        for packet, found in lists:
            if len(found):
                yield encode.records(packet, found)
        yield encode.seconds(PacketId.PLATFORM_TIME, self._clock() - self._began_s)
        of_vehicles = {record.id: record for record in come if _has_physics(record)}
        of_vehicles.update(
            (i, self._known[i]) for i in self.new_physics if i in self._known and _has_physics(self._known[i])
        )
        if of_vehicles:
            control = episode.bodies.physics_control
            yield encode.physics([PhysicsRecord(i, control(record.slot)) for i, record in of_vehicles.items()])
        times = rows_of.light_times(rows, columns.lights)
        changed = times if self._light_times is None else times[times != self._light_times]
        self._light_times = times
        if len(changed):
            yield encode.records(PacketId.LIGHT_TIMES, changed)


def _added(record: ActorRecord, pose: Transform) -> ActorAdded:
    """Return an actor that came, at its place in the world, or relative to its parent, as in CARLA."""
    x, y, z = (finite(along, -FARTHEST_M, FARTHEST_M) for along in pose.location)  # a float32 has to hold them in cm
    kind = record.kind if record.kind in _KINDS_OF_FILE else BlueprintKind.OTHER
    turned = pose.rotation
    return ActorAdded(
        record.id,
        int(kind),
        (x * M_TO_CM, y * M_TO_CM, z * M_TO_CM),
        (turned.roll, turned.pitch, turned.yaw),
        record.description,
    )


def _has_physics(record: ActorRecord) -> bool:
    """Whether an actor is a vehicle that drives; an attached one does not."""
    return record.kind is BlueprintKind.VEHICLE and record.slot != NO_BODY


def _parents(come: list[ActorRecord]) -> StructuredArray:
    return np.array([(record.id, record.parent_id) for record in come if record.parent_id], layouts.PARENT)


def _boxes(come: list[ActorRecord]) -> StructuredArray:
    """Return the local boxes of actors that came; signs have trigger volumes instead."""
    return _rows((record, record.box.location) for record in come if record.kind not in _SIGNALS)


def _trigger_volumes(episode: Episode, come: list[ActorRecord]) -> StructuredArray:
    """Return the trigger volumes, in the world, of lights and signs that came with the map."""
    found = [record for record in come if record.kind in _SIGNALS]
    boxes = [Transform(record.box.location, record.box.rotation) for record in found]
    centres = [compose(episode.transform(record.id), box) for record, box in zip(found, boxes, strict=True)]
    return _rows(zip(found, (centre.location for centre in centres), strict=True))


def _rows(boxes: Iterable[tuple[ActorRecord, Vector3D]]) -> StructuredArray:
    """Return the rows of actors' boxes with these middles."""
    rows = [(one.id, np.array(middle) * M_TO_CM, np.array(one.box.extent) * M_TO_CM) for one, middle in boxes]
    return np.array(rows, layouts.BOX)
