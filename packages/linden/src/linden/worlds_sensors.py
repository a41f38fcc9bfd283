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
from linden.physics.state import NO_BODY, WALKER
from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.enums import AttributeType
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.scenery.actors.actor_meshes import actor_meshes
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
from linden.sensors.runtime.visible_actors import PartRows
from linden.sensors.runtime.world_parts import PartsOfBodies, parts_of_bodies, placed_parts, poses_of_eyes
from linden.sensors.view import Seen, SensorLook
from linden.simulation.episode import Episode

if TYPE_CHECKING:
    from linden.worlds_parts_gpu import BodiesOnDevice, PartsOnGpu
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
    there: "BodiesOnDevice | None"  # the bodies on a GPU; the table then tells only which bodies there are
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
        self._layout: tuple[I32, NDArray[np.bool_], PartsOfBodies] | None = None  # with the worlds and bodies it is of
        self.described: NDArray[np.int16] = np.full((worlds, 1), UNKNOWN, np.int16)
        self.walked_m: F64 = np.zeros((worlds, 0))
        self._base: Seen | None = None
        self._lights = LightStateCache()
        self._casters: list[EmbreeCaster] = []
        self._gpu: GpuSensors | None = None
        self._placing: PartsOnGpu

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
        self._layout = None
        if description.id.startswith("walker."):
            walked_m = np.zeros(self.described.shape)
            walked_m[:, : self.walked_m.shape[1]] = self.walked_m
            self.walked_m = walked_m

    def forget(self, chosen: I32) -> None:
        """Forget the bodies of worlds (K,)."""
        self.described[chosen], self._layout = UNKNOWN, None
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
        base, count = self._scene(), len(asked.chosen)
        poses, (parts, bodies) = self._poses(asked).tolist(), self._bodies(asked)
        begins = parts.begins.tolist()
        lit = [self._lit(base, row) for row in asked.colours] if asked.colours is not None else [base] * count
        spare: list[Caster] = []

        def work(start: int, stop: int) -> None:
            caster = base.caster if not (side_by_side and isinstance(base.caster, EmbreeCaster)) else spare.pop()
            for row in range(start, stop):
                own, pose = slice(begins[row], begins[row + 1]), poses[row]
                instances = Instances._make(column[own] for column in bodies)
                caster.pose(instances)
                seen = lit[row]._replace(caster=caster, instances=instances, now_s=float(asked.now_s[row]))
                measure(row, seen, Transform(Vector3D(*pose[:3]), Rotation(*pose[3:])))
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
        from linden.sensors.casting.warp_worlds import WorldBodies, WorldEyes  # noqa: PLC0415 - Warp, for a GPU
        from linden.worlds_parts_gpu import PartsOnGpu  # noqa: PLC0415 - likewise
        from linden.worlds_sensors_gpu import Eyes, GpuSensors  # noqa: PLC0415 - likewise

        assert asked.there is not None, "worlds on a GPU say where their bodies are"
        if self._gpu is None:
            self._gpu, self._placing = GpuSensors(self._scene()), PartsOnGpu()
        parts = self._parts_of(asked)
        poses = self._placing.poses(asked.there, parts, self._walked_of(asked.table))
        eyes = self._placing.eyes(asked.there, asked.chosen, asked.slot, asked.transform)
        return self._gpu, Eyes(WorldEyes(*eyes), WorldBodies(parts.begins, parts.mesh, poses))

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

    def _parts_of(self, asked: Asked) -> PartsOfBodies:
        """Return the parts of all bodies in worlds (K,); they stay the same until a body comes, goes or changes.

        Raises:
            UserError: a body was not made by `Worlds.spawn`.
        """
        table, chosen = asked.table, asked.chosen
        there = table.state["alive"][chosen] & (table.state["kind"][chosen] != NO_BODY)
        if self._layout is not None:
            known, seen, found = self._layout
            if np.array_equal(known, chosen) and np.array_equal(seen, there):
                return found
        self._refuse_unknown(table, chosen)
        world, slot = np.nonzero(there)
        row = (chosen[world] * table.state.shape[1] + slot).astype(np.int32)
        design = self.described[chosen][there].astype(np.intp)
        found = parts_of_bodies(self._known_parts(), world, row, design, table.state.shape[1], len(chosen))
        self._layout = chosen.copy(), there, found
        return found

    def _poses(self, asked: Asked) -> F64:
        """Return the poses (K, 6) of the sensors."""
        if asked.slot is None:
            return asked.transform
        flat, slots = asked.table.state.reshape(-1), asked.table.state.shape[1]
        return poses_of_eyes(flat, asked.chosen * np.int32(slots) + np.int32(asked.slot), asked.transform)

    def _bodies(self, asked: Asked) -> tuple[PartsOfBodies, Instances]:
        """Return all parts of the bodies in worlds (K,) in their places."""
        parts, table = self._parts_of(asked), asked.table
        flat, spec_of = table.state.reshape(-1), table.spec_of.reshape(-1)
        placed = placed_parts(parts, flat, spec_of, table.specs, self._walked_of(table).reshape(-1))
        lights = np.zeros(len(parts.mesh), np.uint32)
        return parts, Instances(parts.mesh, placed.pose, placed.pose, parts.actor_id, parts.paint, lights, *placed[1:])

    def _walked_of(self, table: BodyTable) -> F64:
        """Return how far (W, S) walkers have walked."""
        walked_m: F64 = np.zeros(table.state.shape)
        walked_m[:, : self.walked_m.shape[1]] = self.walked_m
        return walked_m

    def _known_parts(self) -> PartRows:
        """Return the parts of all designs that were spawned."""
        if self._parts is None:
            self._parts = PartRows.of(self._descriptions, actor_meshes())
        return self._parts

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
