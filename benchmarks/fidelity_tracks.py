"""Real recordings of CARLA as tracks: for each vehicle, frame by frame, where it was and what its driver did."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.protocol.values.control import VehiclePhysicsControl
from linden.protocol.values.space import BoundingBox, Vector3D
from linden.replay.file.layouts import ActorKind
from linden.replay.file.packets import Frame
from linden.replay.file.read import Recording

F64 = NDArray[np.float64]

FARTHEST_JUMP_MPS = 60.0  # faster than this from frame to frame, somebody moved the vehicle
LOWEST_M = -50.0  # ScenarioRunner parks actors far below the ground until it needs them


class Track(NamedTuple):
    """One vehicle without a gap; arrays of N frames, world in m, m/s and rad.

    From frame k to k + 1 it takes ``step_s[k]``, and the controls of frame k + 1 drive the vehicle there: CARLA records
    at a frame's end. The velocity is that of the centre of mass (Unreal's GetVelocity of a simulated body), the place
    that of the actor's origin.
    """

    recording: str
    map_name: str
    actor: int
    type_id: str
    physics: VehiclePhysicsControl
    box: BoundingBox
    time_s: F64
    step_s: F64
    place_m: F64  # (N, 3)
    rotation_rad: F64  # (N, 3) roll, pitch, yaw
    velocity_mps: F64  # (N, 3)
    turn_radps: F64  # (N,) about z
    steer: F64
    throttle: F64
    brake: F64
    hand_brake: NDArray[np.bool_]
    gear: NDArray[np.int32]

    @property
    def name(self) -> str:
        return f"{self.type_id.removeprefix('vehicle.')} in {self.recording}"

    @property
    def speed_mps(self) -> F64:
        """(N,) along the heading, negative backwards."""
        yaw_rad = self.rotation_rad[:, 2]
        speed_mps: F64 = self.velocity_mps[:, 0] * np.cos(yaw_rad) + self.velocity_mps[:, 1] * np.sin(yaw_rad)
        return speed_mps


class _Row(NamedTuple):
    time_s: float
    step_s: float
    place_m: F64
    rotation_rad: F64
    velocity_mps: F64
    turn_radps: float
    controls: tuple[float, float, float, bool, int]


def read_tracks(path: Path) -> list[Track]:
    """Return the tracks of all vehicles whose physics the recording holds; a teleport begins a new one."""
    with Recording(path) as recording:
        frames = list(recording.frames())
        map_name = recording.header.map_name
    kinds = {actor.id: actor for frame in frames for actor in frame.added if actor.kind == ActorKind.VEHICLE}
    physics = {record.id: record.control for frame in frames for record in frame.physics}
    boxes = {int(row["id"]): _box(row) for frame in frames for row in frame.boxes}
    tracks = []
    for actor in sorted(kinds.keys() & physics.keys()):
        for rows in _unbroken(_rows(frames, actor)):
            type_id = kinds[actor].description.id
            tracks += [_track(path.stem, map_name, actor, type_id, physics[actor], boxes[actor], rows)]
    return tracks


def _box(row: np.void) -> BoundingBox:
    centre, half = (tuple(float(x) / 100.0 for x in row[name]) for name in ("origin_cm", "extent_cm"))
    return BoundingBox(Vector3D(*centre), Vector3D(*half))


def _rows(frames: list[Frame], actor: int) -> Iterator[_Row]:
    for frame in frames:
        place, moving, driven = (
            table[table["id"] == actor] for table in (frame.positions, frame.kinematics, frame.vehicles)
        )
        if len(place) and len(moving) and len(driven) and frame.duration_s > 0.0:
            control = driven[0]
            yield _Row(
                frame.elapsed_s,
                frame.duration_s,
                place[0]["location_cm"].astype(float) / 100.0,
                np.radians(place[0]["rotation_deg"].astype(float)),
                moving[0]["velocity_mps"].astype(float),
                float(np.radians(moving[0]["angular_velocity_degps"][2])),
                (
                    float(control["throttle"]),
                    float(control["steer"]),
                    float(control["brake"]),
                    bool(control["hand_brake"]),
                    int(control["gear"]),
                ),
            )


def _unbroken(rows: Iterator[_Row]) -> Iterator[list[_Row]]:
    """Yield stretches on the map without a jump."""
    kept: list[_Row] = []
    for row in rows:
        jumped = kept and np.linalg.norm(row.place_m - kept[-1].place_m) > FARTHEST_JUMP_MPS * kept[-1].step_s
        if kept and (jumped or row.place_m[2] < LOWEST_M):
            yield kept
            kept = []
        if row.place_m[2] >= LOWEST_M:
            kept.append(row)
    if kept:
        yield kept


def _track(
    recording: str,
    map_name: str,
    actor: int,
    type_id: str,
    physics: VehiclePhysicsControl,
    box: BoundingBox,
    rows: list[_Row],
) -> Track:
    throttle, steer, brake, hand_brake, gear = (
        np.array(column) for column in zip(*(r.controls for r in rows), strict=True)
    )
    return Track(
        recording=recording,
        map_name=map_name,
        actor=actor,
        type_id=type_id,
        physics=physics,
        box=box,
        time_s=np.array([r.time_s for r in rows]),
        step_s=np.array([r.step_s for r in rows]),
        place_m=np.array([r.place_m for r in rows]),
        rotation_rad=np.array([r.rotation_rad for r in rows]),
        velocity_mps=np.array([r.velocity_mps for r in rows]),
        turn_radps=np.array([r.turn_radps for r in rows]),
        steer=steer,
        throttle=throttle,
        brake=brake,
        hand_brake=hand_brake.astype(bool),
        gear=gear.astype(np.int32),
    )
