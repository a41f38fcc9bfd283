"""`WorldsSensors`: lidars and cameras in many worlds at once, by the functions of the server's sensors.

One scene and one caster serve all worlds. On the processor the bodies of one world after the other are put into it and
its rays cast. On a GPU one launch casts the rays of all worlds (`worlds_sensors_gpu`), except those of colour pictures.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from linden.blueprints.library import packaged
from linden.errors import Refusal, UserError
from linden.maps.library import LoadedMap
from linden.physics.columns import BodyTable
from linden.physics.state import NO_BODY, VEHICLE, WALKER
from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.enums import AttributeType
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.scenery.actors.actor_meshes import actor_meshes
from linden.scenery.actors.posing import walker_frames
from linden.sensors.camera.cameras import CAMERAS, pixels
from linden.sensors.camera.labels import depth_m
from linden.sensors.casting.caster import CPU, Caster, Instances
from linden.sensors.casting.choose import check_device
from linden.sensors.casting.embree import EmbreeCaster
from linden.sensors.casting.thread_pool import in_stretches, processors
from linden.sensors.devices.lidar.firing_pattern import fire, read_fan
from linden.sensors.devices.lidar.sensor import read_losses, scan
from linden.sensors.runtime.light_state import LightStateCache
from linden.sensors.runtime.sensor_scene import SensorScene
from linden.sensors.runtime.visible_actors import (
    Motion,
    PartRows,
    instances_of,
    matrices,
    poses_of_parts,
    put_vehicles,
    rigid_frames,
)
from linden.sensors.view import Seen, SensorLook
from linden.simulation.episode import Episode
from linden.simulation.snapshot_rows import gather_motion

if TYPE_CHECKING:
    from linden.worlds_sensors_gpu import Eyes, GpuSensors

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
U8 = NDArray[np.uint8]
Value: TypeAlias = str | float | bool

LIDAR = "sensor.lidar.ray_cast"
CAMERA_OF = {
    "depth": "sensor.camera.depth",
    "rgb": "sensor.camera.rgb",
    "semantic": "sensor.camera.semantic_segmentation",
}
"""The camera's blueprint of each kind of pictures."""

UNKNOWN = -1
"""In place of a blueprint: of a body that `Worlds.spawn` has not made."""

MOST_BYTES = 4 * 2**30
_TOGETHER = 64
"""Worlds: the bodies of so many are gathered at once. More take memory and are no faster."""
_FEWEST = 8
"""Worlds that a thread takes at least."""


class LidarScans(NamedTuple):
    """Sweeps of lidars in K worlds, of C channels, the uppermost first, of P rays each."""

    points: Any  # (K, C, P, 4): x, y, z in the sensor's frame, m, and the intensity from 0 to 1; zeros without a return
    hit: Any  # (K, C, P) whether the ray returned


class Asked(NamedTuple):
    """Which worlds (K,) are to be measured, and where the sensors are."""

    table: BodyTable
    chosen: I32
    slot: int | None  # of the body that carries the sensor; None where the sensor stands in the world
    transform: F64  # (K, 6) of the sensor: relative to that body, or in the world; m and degrees
    frames: NDArray[np.int64]  # (K,) steps since each world was reset
    now_s: F64  # (K,)
    colours: U8 | None  # (K, L) of the traffic lights; None where their colour cannot be seen


class WorldsSensors:
    """Sensors of many worlds on one map, and what they need to know of the bodies beyond their state.

    Attributes:
        described: (W, S) row in the list of blueprints of what was spawned in a slot, or `UNKNOWN`.
        walked_m: (W, S) how far walkers have walked; their legs follow from it.
    """

    def __init__(self, world_map: LoadedMap, worlds: int, device: str) -> None:
        self._map, self._device = world_map, device
        self._descriptions: list[ActorDescription] = []
        self._parts: PartRows | None = None
        self.described: NDArray[np.int16] = np.full((worlds, 1), UNKNOWN, np.int16)
        self.walked_m: F64 = np.zeros((worlds, 0))
        self._base: Seen | None = None
        self._lights = LightStateCache()
        self._casters: list[EmbreeCaster] = []
        self._gpu: GpuSensors | None = None

    # -- what the bodies are -------------------------------------------------------------------------------------------

    def note(self, chosen: I32, slot: int, slots: int, description: ActorDescription) -> None:
        """Note what was spawned in a slot of worlds (K,), all of which have so many ``slots`` now."""
        if self.described.shape[1] < slots:
            grown = np.full((len(self.described), slots), UNKNOWN, np.int16)
            grown[:, : self.described.shape[1]] = self.described
            self.described = grown
        if description not in self._descriptions:
            self._descriptions.append(description)
            self._parts = None
        self.described[chosen, slot] = self._descriptions.index(description)
        if description.id.startswith("walker."):
            walked_m = np.zeros(self.described.shape)
            walked_m[:, : self.walked_m.shape[1]] = self.walked_m
            self.walked_m = walked_m

    def forget(self, chosen: I32) -> None:
        """Forget the bodies of worlds (K,)."""
        self.described[chosen] = UNKNOWN
        self.begin(chosen)

    def begin(self, chosen: I32) -> None:
        """Let walkers of worlds (K,) begin to walk."""
        self.walked_m[chosen] = 0.0

    def step(self, table: BodyTable, running: I32, dt_s: float) -> None:
        """Count the steps of walkers in worlds (K,) after a step of the worlds, as `simulation.walkers` does."""
        slots = min(self.walked_m.shape[1], table.state.shape[1])
        if slots:
            state = table.state[running, :slots]
            stride_m = np.hypot(state["velocity"][..., 0], state["velocity"][..., 1]) * dt_s
            self.walked_m[running, :slots] += np.where(state["kind"] == WALKER, stride_m, 0.0)

    # -- measurements --------------------------------------------------------------------------------------------------

    def lidar(
        self, attributes: dict[str, Value], start_deg: float, interval_s: float, asked: Asked, *, on_device: bool
    ) -> LidarScans:
        """Return the sweeps of lidars in worlds (K,), each from ``start_deg`` on for a time.

        Raises:
            UserError: there is no such attribute, or it takes no such value; or the sweeps need too much memory; or
                they depend on chance and are to stay on the device.
        """
        whole_turn: dict[str, Value] = {"rotation_frequency": 1.0 / interval_s}
        description = _described(LIDAR, whole_turn | attributes)
        fan, losses = read_fan(description), read_losses(description)
        fired = fire(fan, start_deg, interval_s)
        shape = len(asked.chosen), len(fired.up), len(fired.sine)
        _refuse_too_much(shape, 17, "rays")
        if on_device:
            sensors, eyes = self._on_gpu(asked)
            return LidarScans(*sensors.scans(fan, losses, start_deg, interval_s, eyes))
        found = LidarScans(np.zeros((*shape, 4), np.float32), np.zeros(shape, np.bool_))
        points, hit = found.points.reshape(shape[0], -1, 4), found.hit.reshape(shape[0], -1)
        own = [losses._replace(seed=losses.seed + world) for world in asked.chosen.tolist()]
        numbers = np.maximum(asked.frames - 1, 0).tolist()
        if self._device != CPU:
            sensors, eyes = self._on_gpu(asked)
            sensors.write_scans(fan, own, start_deg, interval_s, eyes, numbers, points, hit)
            return found

        def measure(index: int, seen: Seen, pose: Transform) -> None:
            _, met, rays = scan(fan, own[index], fired, numbers[index], pose, seen.caster)
            points[index, rays], hit[index, rays] = met, True

        self._look(asked, measure, side_by_side=True)
        return found

    def pictures(self, kind: str, attributes: dict[str, Value], asked: Asked, *, on_device: bool) -> Any:  # noqa: ANN401
        """Return pictures in worlds (K,): metres (K, H, W), tags (K, H, W), or R, G, B (K, H, W, 3).

        Raises:
            UserError: there is no such kind or attribute, or it takes no such value; or they need too much memory; or
                coloured ones are to stay on the device.
        """
        if kind not in CAMERA_OF:
            raise UserError(f"there are no pictures of kind {kind!r}; there are {', '.join(sorted(CAMERA_OF))}")
        blueprint = CAMERA_OF[kind]
        try:
            picture = CAMERAS[blueprint](_described(blueprint, attributes)).picture
        except Refusal as error:
            raise UserError(_reason(error)) from error
        shape: tuple[int, ...] = (len(asked.chosen), picture.spec.height_px, picture.spec.width_px)
        _refuse_too_much(shape, 4, "pixels")
        if kind == "rgb" and on_device:
            raise UserError("pictures of kind 'rgb' come back to the host; use on_device=False")
        if kind != "rgb" and self._device != CPU:
            sensors, eyes = self._on_gpu(asked)
            there = sensors.picture(kind, picture.spec, eyes)
            return there if on_device else there.numpy()
        found = np.empty((*shape, 3) if kind == "rgb" else shape, np.float32 if kind == "depth" else np.uint8)

        def measure(index: int, seen: Seen, pose: Transform) -> None:
            made = np.asarray(pixels(picture, SensorLook(seen, {}, pose, pose, np.zeros(3), 0, 0, 0.0)), np.uint8)
            if kind == "depth":
                found[index] = depth_m(made)
            else:
                found[index] = made[..., 2::-1] if kind == "rgb" else made[..., 2]

        self._look(asked, measure, side_by_side=kind != "rgb")  # all processors make a coloured picture
        return found

    # -- what they see -------------------------------------------------------------------------------------------------

    def _look(self, asked: Asked, measure: Callable[[int, Seen, Transform], None], *, side_by_side: bool) -> None:
        """Call ``measure`` for each world with its number, what is seen, and the pose of the sensor.

        ``side_by_side``: several threads take worlds, each with a caster of its own.

        Raises:
            UserError: a body was not made by `Worlds.spawn`.
        """
        self._refuse_unknown(asked.table, asked.chosen)
        base, count = self._scene(), len(asked.chosen)
        self._known_parts()  # by one thread, before several ask for them
        lit = [self._lit(base, row) for row in asked.colours] if asked.colours is not None else [base] * count
        spare: list[Caster] = []

        def work(start: int, stop: int) -> None:
            caster = base.caster if not (side_by_side and isinstance(base.caster, EmbreeCaster)) else spare.pop()
            for first in range(start, stop, _TOGETHER):
                part = slice(first, min(stop, first + _TOGETHER))
                poses, begins, bodies = self._gathered(asked, part)
                for row, pose in enumerate(poses.tolist()):
                    own = slice(begins[row], begins[row + 1])
                    instances = Instances._make(column[own] for column in bodies)
                    caster.pose(instances)
                    seen = lit[first + row]._replace(
                        caster=caster, instances=instances, now_s=float(asked.now_s[first + row])
                    )
                    measure(first + row, seen, Transform(Vector3D(*pose[:3]), Rotation(*pose[3:])))
            spare.append(caster)

        if side_by_side and isinstance(base.caster, EmbreeCaster):
            self._grow_casters(base.caster)
            spare += self._casters
            in_stretches(count, work, multiple=1, fewest=_FEWEST)
        else:
            work(0, count)

    def _on_gpu(self, asked: Asked) -> "tuple[GpuSensors, Eyes]":
        """Return the sensors on the GPU, and the poses of sensors and bodies in the worlds.

        Raises:
            UserError: a body was not made by `Worlds.spawn`.
        """
        from linden.sensors.casting.warp_worlds import WorldBodies  # noqa: PLC0415 - Warp, which users of a GPU have
        from linden.worlds_sensors_gpu import Eyes, GpuSensors  # noqa: PLC0415 - likewise

        self._refuse_unknown(asked.table, asked.chosen)
        if self._gpu is None:
            self._gpu = GpuSensors(self._scene())
        poses, begins, parts, rows, places = self._placed(asked, slice(0, len(asked.chosen)))
        pose, _ = poses_of_parts(parts, places, self._frames(asked.table, rows))
        return self._gpu, Eyes(matrices(poses).astype(np.float32), WorldBodies(begins, parts.mesh, pose))

    def _grow_casters(self, caster: EmbreeCaster) -> None:
        """Make a caster for each thread, and the trees of all bodies."""
        caster.build_trees(self._known_parts().mesh)
        while len(self._casters) < processors():
            self._casters.append(caster.sibling())

    def _scene(self) -> Seen:
        """Return the map without bodies; it is built at the first call."""
        if self._base is None:
            check_device(self._device)
            scene = SensorScene()
            scene.device = self._device
            self._episode = Episode(self._map, first_frame=0)
            self._base = scene.look(self._episode, 0)
        return self._base

    def _lit(self, seen: Seen, colours: U8) -> Seen:
        """Return what is seen with the traffic lights (L,) in these colours."""
        self._episode.traffic.state.colour[:] = colours
        states = self._lights.of(self._episode)
        return seen._replace(object_lights=states.lights, object_light_colour=states.colour)

    def _gathered(self, asked: Asked, part: slice) -> tuple[F64, I32, Instances]:
        """Return the poses (K, 6) of sensors in some worlds, and all bodies with where each world's begin (K + 1,)."""
        poses, begins, parts, rows, places = self._placed(asked, part)
        bodies = asked.table.state.reshape(-1)
        motion = Motion(
            places,
            bodies["velocity"][rows],
            bodies["angular_velocity"][rows],
            (rows % asked.table.state.shape[1] + 1).astype(np.uint32),
            np.zeros(len(rows), np.uint32),
        )
        return poses, begins, instances_of(parts, motion, self._frames(asked.table, rows))

    def _placed(self, asked: Asked, part: slice) -> tuple[F64, I32, PartRows, I32, F64]:
        """Return where sensors and bodies of some worlds (K,) are.

        The first two are the poses (K, 6) of the sensors and where the parts of each world begin (K + 1,). The parts of
        all bodies, the flat rows (A,) of the bodies and their poses (A, 3, 4) follow.
        """
        table, slot, chosen, transform = asked.table, asked.slot, asked.chosen[part], asked.transform[part]
        flat, slots = table.state.reshape(-1), table.state.shape[1]
        alive = table.state["alive"][chosen] & (table.state["kind"][chosen] != NO_BODY)
        world, own_slot = np.nonzero(alive)
        rows = (chosen[world] * slots + own_slot).astype(np.int32)
        poses, relative = np.zeros((len(rows) + len(chosen), 6)), np.zeros((len(rows) + len(chosen), 6))
        parent, moved_by = np.full(len(poses), -1, np.int32), np.full(len(poses), -1, np.int32)
        moved_by[: len(rows)] = rows
        relative[len(rows) :] = poses[len(rows) :] = transform
        if slot is not None:
            parent[len(rows) :] = np.flatnonzero(own_slot == slot)
        gather_motion(
            len(poses), poses, relative, parent, moved_by, flat["position"], flat["rotation"], flat["velocity"],
            flat["angular_velocity"], flat["acceleration"], np.zeros((len(poses), 15), np.float32),
        )  # fmt: skip
        parts = _parts_of(self._known_parts(), self.described[chosen][alive].astype(np.intp))
        begins = np.searchsorted(world[parts.actor], np.arange(len(chosen) + 1)).astype(np.int32)
        return poses[len(rows) :], begins, parts, rows, matrices(poses[: len(rows)])

    def _known_parts(self) -> PartRows:
        """Return the parts of all designs that were spawned."""
        if self._parts is None:
            self._parts = PartRows.of(self._descriptions, actor_meshes())
        return self._parts

    def _frames(self, table: BodyTable, rows: I32) -> F64:
        """Return the frames (A, 14, 3, 4) of the parts of bodies in flat rows (A,)."""
        frames, bodies = rigid_frames(len(rows)), table.state.reshape(-1)[rows]
        vehicles = np.flatnonzero(bodies["kind"] == VEHICLE)
        if len(vehicles):
            specs = table.specs[table.spec_of.reshape(-1)[rows[vehicles]]]
            put_vehicles(frames, vehicles, specs, bodies["wheel_steer"][vehicles], bodies["wheel_turned"][vehicles])
        walkers = np.flatnonzero(bodies["kind"] == WALKER)
        if len(walkers):
            world, slot = np.divmod(rows[walkers], table.state.shape[1])
            velocity = bodies["velocity"][walkers]
            frames[walkers] = walker_frames(
                2.0 * bodies["half_extent"][walkers, 2],
                self.walked_m[world, slot],
                np.hypot(velocity[:, 0], velocity[:, 1]),
            )
        return frames

    def _refuse_unknown(self, table: BodyTable, chosen: I32) -> None:
        slots = min(self.described.shape[1], table.state.shape[1])
        unknown = table.state["alive"][chosen]
        unknown[:, :slots] &= self.described[chosen, :slots] == UNKNOWN
        where = np.argwhere(unknown)
        if len(where):
            raise UserError(
                f"the body in slot {where[0][1]} of world {chosen[where[0][0]]} was not made by `spawn`, so it has no "
                "look; leave that world out, or spawn the body"
            )


def _parts_of(designs: PartRows, design: NDArray[np.intp]) -> PartRows:
    """Return the parts of actors (A,), each of a design, from the parts of all designs."""
    begins = np.searchsorted(designs.actor, np.arange(design.max(initial=-1) + 2))
    count = begins[design + 1] - begins[design]
    actor = np.repeat(np.arange(len(design)), count)
    behind = np.arange(len(actor)) - np.repeat(np.cumsum(count) - count, count)
    rows = begins[design][actor] + behind
    return PartRows(actor, designs.mesh[rows], designs.frame[rows], designs.paint[rows], designs.scale[rows])


def _described(blueprint: str, attributes: dict[str, Value]) -> ActorDescription:
    """Return the complete description of a sensor.

    Raises:
        UserError: it has no such attribute, or the attribute takes no such value.
    """
    given = tuple(AttributeValue(name, AttributeType.STRING, _text(value)) for name, value in attributes.items())
    try:
        return packaged().validate(ActorDescription(0, blueprint, given))
    except Refusal as error:
        raise UserError(_reason(error)) from error


def _text(value: Value) -> str:
    return str(value).lower() if isinstance(value, (bool, np.bool_)) else str(value)


def _reason(error: Refusal) -> str:
    return str(error).rpartition("invalid actor description: ")[2]


def _refuse_too_much(shape: tuple[int, ...], each: int, what: str) -> None:
    needed = int(np.prod(shape, dtype=np.int64)) * each
    if needed > MOST_BYTES:
        raise UserError(
            f"{shape[0]} worlds of {shape[1]} x {shape[2]} {what} take {needed / 2**30:.1f} GiB, and "
            f"{MOST_BYTES / 2**30:.0f} GiB are the most; measure some of the worlds at a time"
        )
