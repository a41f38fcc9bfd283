"""`Worlds`: many worlds on one map, stepped together in one process; their states are arrays with the worlds first.

All worlds share the map, its scenery and one table of vehicle specifications. Each has bodies of its own. A world with
the actors and the controls of the server's world equals that, byte for byte.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from linden.blueprints.library import Blueprint, BlueprintKind, packaged
from linden.errors import UserError
from linden.maps.ground import Ground
from linden.maps.library import HOME_MAP, MapLibrary
from linden.physics.bodies import FARTHEST_M, Bodies, place_rows
from linden.physics.columns import BodyTable
from linden.physics.contact.statics import Statics
from linden.physics.state import BODY, VEHICLE, WALKER
from linden.physics.step import CONTACT, Contacts, advance_worlds, contacts_of
from linden.physics.vehicle.controls import set_controls
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.episode import EpisodeSettings
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.sensors.camera.spec import LARGEST_SIDE_PX
from linden.sensors.casting.thread_pool import in_stretches
from linden.simulation.below_ground import DEEP_M
from linden.simulation.episode import limits_of_lanes_kmh
from linden.simulation.snapshot_rows import limits_under
from linden.simulation.spawning import NEEDS_ROOM, bodies_at, embody, scenery_at
from linden.simulation.surroundings import scenery_of
from linden.structured import StructuredArray
from linden.traffic.traffic import Traffic
from linden.world import clock_s, substeps_of
from linden.worlds_sensors import Asked, LidarScans, Value, WorldsSensors

if TYPE_CHECKING:
    from linden.worlds_gpu import DeviceColumn, GpuWorlds

F64 = NDArray[np.float64]
Chosen: TypeAlias = Sequence[int] | NDArray[np.integer[Any]] | None
"""Numbers of worlds, each once; None: all of them."""

STEP_S = 0.05
FEWEST_WORLDS = 32
"""What a thread takes at least: to hand fewer out costs more than to work on them."""

_KINDS = (BlueprintKind.VEHICLE, BlueprintKind.WALKER, BlueprintKind.PROP)
_MOST_WORLDS = 10_000_000


class Worlds:
    """A number of worlds on one map.

    Attributes:
        map: the map; never changes.
        count: how many worlds there are.
        dt_s: simulated time of a step.
    """

    def __init__(
        self,
        map_name: str = HOME_MAP,
        count: int = 1,
        *,
        device: str = "cpu",
        dt_s: float = STEP_S,
        threads: int = 0,
        maps: MapLibrary | None = None,
    ) -> None:
        """Make empty worlds; ``threads`` work on them, 0 being all processors. Results do not depend on ``threads``.

        Raises:
            UserError: the count, the device, the time of a step or the threads cannot be used.
            Refusal: there is no such map.
        """
        self.count = _whole("count", count, 1, _MOST_WORLDS)
        self._threads = _whole("threads", threads, 0, 4096)
        if device not in {"cpu", "cuda"}:
            raise UserError(f"Worlds cannot run on device {device!r}; use device='cpu' or device='cuda'")
        if not (isinstance(dt_s, (int, float)) and 0.0 < dt_s <= 1.0):
            raise UserError(f"dt_s is the time of a step in seconds, above 0 and at most 1, not {dt_s!r}")
        self.dt_s = float(dt_s)
        self._substeps = substeps_of(EpisodeSettings(), self.dt_s)
        self.map = (MapLibrary() if maps is None else maps).load(map_name)
        self._scenery = scenery_of(self.map)
        self._traffic = Traffic(self._scenery.signals)
        self._colours = [self._traffic.state.colour]
        self._table, self._first = BodyTable(self.count, slots=1), BodyTable(self.count, slots=1)
        self._contacts: Contacts | None = np.zeros(0, CONTACT)
        self._valid = np.ones(self.count, np.bool_)
        self._frames = np.zeros(self.count, np.int64)
        self._gpu = _gpu(self.map.ground, self._scenery.statics) if device == "cuda" else None
        self._host_is_current = True
        self._limit_of_lane_kmh: F64 | None = None
        self._all = np.arange(self.count, dtype=np.int32)
        self._sensors = WorldsSensors(self.map, self.count, device)

    # -- actors --------------------------------------------------------------------------------------------------------

    def spawn(self, blueprint_id: str, at: int | ArrayLike, worlds: Chosen = None) -> int:
        """Put one actor into each of ``worlds`` (K,) and return its slot, the same in all of them.

        ``at`` is the number of a spawn point, or an array (K,) of such numbers. Or it is poses, (6,) or (K, 6): x, y, z
        in m, then pitch, yaw, roll in degrees. A later :meth:`reset` brings back the state after this call.

        Raises:
            UserError: ``at`` or ``worlds`` cannot be used, or something stands there; no world has changed then.
            Refusal: there is no such blueprint.
        """
        blueprint = packaged().find(blueprint_id)
        if blueprint.kind not in _KINDS:
            raise UserError(f"{blueprint_id} has no body; spawn vehicles, walkers and props into Worlds")
        chosen = self._chosen(worlds)
        self._edit()
        poses, pose_of_world = np.unique(self._poses(at, len(chosen)), axis=0, return_inverse=True)
        pose_of_world = pose_of_world.reshape(-1)
        self._refuse_deep(poses)
        transforms = [Transform(Vector3D(*pose[:3]), Rotation(*pose[3:])) for pose in poses.tolist()]
        if blueprint.kind in NEEDS_ROOM:
            self._refuse_without_room(blueprint, transforms, chosen, pose_of_world)
        description = packaged().validate(ActorDescription(0, blueprint_id))
        slot = int(self._table.counts[chosen].max())
        while slot >= self._table.state.shape[1]:
            self._table.grow()
            self._first.grow()
        made = Bodies(self._table, int(chosen[0]))  # its free slots lend room to the prototypes
        for number, transform in enumerate(transforms):
            prototype = Bodies(BodyTable(1, slots=1))
            own = embody(prototype, blueprint, description, transform)
            mine = chosen[pose_of_world == number]
            self._table.state[mine, slot] = prototype.state[own]
            if prototype.kind[own] == VEHICLE:
                design = prototype.design(own)
                row = made.table.row_of(design, lambda: prototype.spec(own))  # noqa: B023 - called before the next turn
                self._table.spec_of[mine, slot] = row
        self._table.counts[chosen] = slot + 1
        self._sensors.note(chosen, slot, self._table.state.shape[1], description)
        self._keep_as_first(chosen)
        return slot

    def place(self, poses: ArrayLike, slot: int = 0, worlds: Chosen = None) -> None:
        """Put the bodies in a slot of ``worlds`` (K,) at ``poses``, (6,) or (K, 6): m, degrees; they keep their speed.

        Raises:
            UserError: the arguments cannot be used; no world has changed then.
        """
        chosen = self._chosen(worlds)
        rows = self._rows(slot, chosen)
        wanted = self._poses(poses, len(chosen))
        self._edit()
        self._refuse_deep(np.unique(wanted, axis=0))
        place_rows(self._table.state.reshape(-1), rows, wanted)

    def set_velocity(self, velocity_mps: ArrayLike, slot: int = 0, worlds: Chosen = None) -> None:
        """Set the velocity, (3,) or (K, 3) in the world frame, of the bodies in a slot of ``worlds`` (K,).

        Raises:
            UserError: the arguments cannot be used; no world has changed then.
        """
        chosen = self._chosen(worlds)
        self._rows(slot, chosen)
        wanted = _numbers("velocity_mps", velocity_mps, (len(chosen), 3))
        self._edit()
        for world, velocity in zip(chosen.tolist(), wanted.tolist(), strict=True):
            self.bodies(world).set_target_velocity(slot, velocity)

    def set_state(self, states: StructuredArray, slot: int = 0, worlds: Chosen = None) -> None:
        """Give the bodies in a slot of ``worlds`` (K,) the states (K,) of BODY, as :attr:`state` has them.

        What the body is (kind, specification) stays. So the states must be of bodies that were spawned alike.

        Raises:
            UserError: the arguments cannot be used; no world has changed then.
        """
        chosen = self._chosen(worlds)
        rows = self._rows(slot, chosen)
        given = np.asarray(states)
        if given.dtype != BODY or given.shape != (len(chosen),):
            raise UserError(f"states needs an array ({len(chosen)},) of BODY, as `state` has, not {_short(states)}")
        if (given["kind"] != self._table.state["kind"][chosen, slot]).any() or not given["alive"].all():
            raise UserError(
                f"a state is of another kind of body than that in slot {slot}; spawn the same actor in both"
            )
        if not (np.abs(given["position"]) < FARTHEST_M).all():  # false of nan as well
            raise UserError("a state has a position that is not a finite place")
        if self._gpu is not None and self._gpu.is_current:
            self._gpu.set_state(rows, np.ascontiguousarray(given))
            self._host_is_current = False
        else:
            self._table.state.reshape(-1)[rows] = given

    def bodies(self, world: int) -> Bodies:
        """Return the bodies of one world as the server has them: a view, by which everything can be read and set."""
        number = _whole("world", world, 0, self.count - 1)
        self._edit()
        return Bodies(self._table, number)

    # -- controls ------------------------------------------------------------------------------------------------------

    def set_controls(self, controls: ArrayLike, slot: int = 0, worlds: Chosen = None) -> None:
        """Set the controls of the vehicles in a slot of ``worlds`` (K,); they hold until the next.

        ``controls`` is (3,) or (K, 3) of throttle, steer and brake, or (7,) or (K, 7) with hand brake, reverse, manual
        gear shift and gear. Throttle and brake are held in [0, 1], steer in [-1, 1].

        Raises:
            UserError: the arguments cannot be used; no world has changed then.
        """
        chosen = self._chosen(worlds)
        rows = self._rows(slot, chosen, VEHICLE)
        given = np.asarray(controls)
        width = 7 if given.ndim and given.shape[-1] == 7 else 3
        whole = np.zeros((len(chosen), 7))
        whole[:, :width] = _numbers("controls", given, (len(chosen), width))
        if self._gpu is not None and self._gpu.is_current:
            self._gpu.set_controls(rows, whole)
            self._host_is_current = False
        else:
            set_controls(self._table.state.reshape(-1), rows, whole)

    def set_walks(self, directions: ArrayLike, speeds_mps: ArrayLike, slot: int = 0, worlds: Chosen = None) -> None:
        """Let the walkers in a slot of ``worlds`` (K,) go on in ``directions`` (3,) or (K, 3) at speeds () or (K,).

        Raises:
            UserError: the arguments cannot be used; no world has changed then.
        """
        chosen = self._chosen(worlds)
        rows = self._rows(slot, chosen, WALKER)
        ways = _numbers("directions", directions, (len(chosen), 3))
        speeds = _numbers("speeds_mps", speeds_mps, (len(chosen),))
        self._edit()
        state = self._table.state.reshape(-1)
        state["walker_direction"][rows] = np.clip(ways, -1e3, 1e3)
        state["walker_speed"][rows] = np.clip(speeds, 0.0, 50.0)

    # -- time ----------------------------------------------------------------------------------------------------------

    def step(self) -> None:
        """Advance all valid worlds by ``dt_s``."""
        if self._gpu is not None:
            self._step_on_gpu(self._gpu)
            return
        running = self._all if self._valid.all() else np.flatnonzero(self._valid).astype(np.int32)
        ground, statics = self.map.ground, self._scenery.statics
        touched: dict[int, Contacts] = {}

        def work(start: int, stop: int) -> None:
            some = running[start:stop]
            touched[start] = advance_worlds(self._table, some, ground, statics, self.dt_s, self._substeps)

        in_stretches(len(running), work, multiple=1, fewest=FEWEST_WORLDS, threads=self._threads)
        met = [touched[start] for start in sorted(touched) if len(touched[start])]
        self._contacts = np.concatenate(met) if met else np.zeros(0, CONTACT)
        self._frames[running] += 1
        self._sensors.step(self._table, running, self.dt_s)
        position_m = self._table.state["position"]
        inside = np.abs(position_m) < FARTHEST_M  # false of nan as well
        self._valid[running] = inside.all(axis=(1, 2))[running]

    def _step_on_gpu(self, gpu: "GpuWorlds") -> None:
        self._upload(gpu)
        gpu.step(self.dt_s, self._substeps)
        self._host_is_current, self._contacts = False, None

    def _upload(self, gpu: "GpuWorlds") -> None:
        """Bring the device up to date with the host."""
        if not gpu.is_current:
            gpu.upload(self._table, self._first, self._valid, self._frames)

    def _read_marks(self) -> None:
        """Bring `valid` and `frames` of the host up to date with the device, but no body."""
        if self._gpu is not None and not self._host_is_current:
            self._gpu.download_marks(self._valid, self._frames)

    def _read(self) -> None:
        """Bring the arrays of the host up to date with the device."""
        if self._gpu is not None and not self._host_is_current:
            self._gpu.download(self._table, self._valid, self._frames)
            self._host_is_current = True

    def _edit(self) -> None:
        """Bring the arrays of the host up to date before they change; the device gets them before its next step."""
        self._read()
        if self._gpu is not None:
            self._keep_contacts()
            self._gpu.is_current = False

    def _keep_contacts(self) -> Contacts:
        if self._contacts is None:
            assert self._gpu is not None
            self._contacts = contacts_of(self._gpu.touched(), self._scenery.statics)
        return self._contacts

    def reset(self, worlds: Chosen = None) -> None:
        """Set ``worlds`` back to the state at their last spawn.

        Raises:
            UserError: there is no such world.
        """
        chosen = self._chosen(worlds)
        if self._gpu is not None and self._gpu.is_current:
            self._keep_contacts()
            self._gpu.reset(chosen)
            for name in ("alive", "kind"):  # which bodies there are is known without the device
                self._table.state[name][chosen] = self._first.state[name][chosen]
            self._host_is_current = False
            self._forget_contacts(chosen)
            return
        self._table.state[chosen] = self._first.state[chosen]
        self._table.spec_of[chosen] = self._first.spec_of[chosen]
        self._begin(chosen)

    def keep(self, worlds: Chosen = None) -> None:
        """Let a later :meth:`reset` bring ``worlds`` back to the state that they are in now.

        Raises:
            UserError: there is no such world.
        """
        chosen = self._chosen(worlds)
        self._edit()
        self._keep_as_first(chosen)

    def clear(self, worlds: Chosen = None) -> None:
        """Take all actors out of ``worlds``.

        Raises:
            UserError: there is no such world.
        """
        chosen = self._chosen(worlds)
        self._edit()
        self._table.state[chosen] = np.zeros((), self._table.state.dtype)
        self._table.spec_of[chosen] = 0
        self._table.counts[chosen] = 0
        self._sensors.forget(chosen)
        self._keep_as_first(chosen)
        self._begin(chosen)

    # -- sensors -------------------------------------------------------------------------------------------------------

    def lidar(
        self,
        transform: ArrayLike,
        *,
        slot: int | None = 0,
        worlds: Chosen = None,
        start_deg: float = 0.0,
        on_device: bool = False,
        **attributes: Value,
    ) -> LidarScans:
        """Return what a lidar measures in each of ``worlds`` (K,): the sweep of one step, from ``start_deg`` on.

        ``transform``, (6,) or (K, 6), is its place in m and degrees. It counts from the body in ``slot``; for None it
        counts from the world's origin.
        ``attributes`` are those of CARLA's ``sensor.lidar.ray_cast``. Their defaults are CARLA's but for
        ``rotation_frequency``, with which a step is a whole turn. The noise changes in each step; its seed is
        ``noise_seed`` and the number of the world together. With ``on_device`` the arrays stay on the GPU, and PyTorch,
        JAX and CuPy take them without a copy. No point may then depend on chance.

        Raises:
            UserError: the arguments cannot be used, or a world is not valid; no world changes in any case.
        """
        if isinstance(start_deg, bool) or not isinstance(start_deg, (int, float)) or not 0.0 <= start_deg < 360.0:
            raise UserError(f"start_deg is an angle from 0 to below 360, not {_short(start_deg)}")
        self._refuse_without_gpu(on_device)
        asked = self._asked(transform, slot, worlds, lit=False)
        return self._sensors.lidar(attributes, float(start_deg), clock_s(self.dt_s), asked, on_device=on_device)

    def pictures(
        self,
        kind: str,
        transform: ArrayLike,
        *,
        size: tuple[int, int] = (64, 64),
        fov: float = 90.0,
        slot: int | None = 0,
        worlds: Chosen = None,
        on_device: bool = False,
        **attributes: Value,
    ) -> Any:  # noqa: ANN401 - an array of numpy's, or of Warp's on the device
        """Return what a camera shows in each of ``worlds`` (K,).

        Depth is (K, H, W) in m. Semantic pictures are (K, H, W) tags of CARLA. Pictures of ``kind`` "rgb" are
        (K, H, W, 3) bytes. Their ``size`` is width and height in pixels. The horizontal angle ``fov`` is in degrees.
        The arguments ``transform``, ``slot`` and ``on_device`` are as for :meth:`lidar`; pictures of kind "rgb" cannot
        stay on the device. ``attributes`` are those of CARLA's camera of that kind.

        Raises:
            UserError: the arguments cannot be used, or a world is not valid; no world changes in any case.
        """
        try:
            width, height = size
        except (TypeError, ValueError):
            raise UserError(f"size is the width and the height of the pictures, not {_short(size)}") from None
        for name, side in (("the width", width), ("the height", height)):
            _whole(name, side, 1, LARGEST_SIDE_PX)
        self._refuse_without_gpu(on_device)
        asked = self._asked(transform, slot, worlds, lit=kind == "rgb")
        given = {"image_size_x": width, "image_size_y": height, "fov": fov} | attributes
        return self._sensors.pictures(kind, given, asked, on_device=on_device)

    def _refuse_without_gpu(self, on_device: bool) -> None:  # noqa: FBT001 - the user's argument
        """Raise UserError where arrays are to stay on a device and there is none."""
        if on_device and self._gpu is None:
            raise UserError("on_device=True needs worlds on a GPU; make them with device='cuda'")

    def _asked(self, transform: ArrayLike, slot: int | None, worlds: Chosen, *, lit: bool) -> Asked:
        """Return which worlds are to be measured, and where the sensors are.

        Raises:
            UserError: the arguments cannot be used.
        """
        chosen = self._chosen(worlds)
        wanted = _numbers("transform (x, y, z, pitch, yaw, roll)", transform, (len(chosen), 6))
        if slot is not None:
            self._rows(slot, chosen)
        there = None
        if self._gpu is not None and not lit:
            self._upload(self._gpu)
            there = self._gpu.bodies
        else:
            self._read()
        lost = chosen[~self.valid[chosen]]
        if len(lost):
            raise UserError(f"world {lost[0]} is not valid, since a body of it got lost; reset it or leave it out")
        colours = self.light_colours[chosen] if lit else None
        return Asked(self._table, chosen, slot, wanted, there, self.frames[chosen], self.elapsed_s[chosen], colours)

    # -- what there is -------------------------------------------------------------------------------------------------

    @property
    def statics(self) -> Statics:
        """Boxes of the scenery that bodies can hit; never changes."""
        return self._scenery.statics

    @property
    def contacts(self) -> Contacts:
        """What touched in the last step, of ``linden.physics.step.CONTACT``, ordered by world; read only."""
        return self._keep_contacts()

    @property
    def valid(self) -> NDArray[np.bool_]:
        """(W,) False from the step on in which a body of a world got lost in space, until the world is reset.

        Such a world stands still. On a GPU so does a world with more near pairs than there is room for.
        """
        self._read_marks()
        return self._valid

    @property
    def frames(self) -> NDArray[np.int64]:
        """(W,) steps since each world was reset."""
        self._read_marks()
        return self._frames

    def on_device(self, name: str) -> "DeviceColumn":
        """Return a column of ``state`` (W, S, ...) where it lies on the GPU, as PyTorch and CuPy take it.

        The next call that changes actors or places makes it stale.

        Raises:
            UserError: the worlds are not on a GPU, or there is no such column.
        """
        if self._gpu is None:
            raise UserError("these worlds are in the memory of the processor; read `state`, or use device='cuda'")
        if name not in (BODY.names or ()):
            raise UserError(f"bodies have no column {name!r}; they have {', '.join(BODY.names or ())}")
        self._upload(self._gpu)
        return self._gpu.column(name)

    def wait(self) -> None:
        """Wait until the GPU has done all steps; without one there is nothing to wait for."""
        if self._gpu is not None:
            self._gpu.wait()

    @property
    def state(self) -> StructuredArray:
        """(W, S) of ``linden.physics.state.BODY``: all bodies, to be read only; ``["alive"]`` tells which rows are."""
        self._read()
        state = self._table.state[:, : int(self._table.counts.max())]
        state.flags.writeable = False
        return state

    @property
    def poses(self) -> F64:
        """(W, S, 6) x, y, z in m, pitch, yaw, roll in degrees."""
        state = self.state
        poses: F64 = np.empty((*state.shape, 6))
        poses[..., :3], poses[..., 3:] = state["position"], np.degrees(state["rotation"])
        return poses

    @property
    def elapsed_s(self) -> F64:
        """(W,) simulated time since each world was reset."""
        elapsed_s: F64 = np.multiply(self.frames, clock_s(self.dt_s), dtype=np.float64)
        return elapsed_s

    @property
    def light_colours(self) -> NDArray[np.uint8]:
        """(W, L) ``TrafficLightState`` of each light of the map in each world."""
        while len(self._colours) <= self.frames.max():
            self._traffic.step(self.dt_s)
            self._colours.append(self._traffic.state.colour)
        known, which = np.unique(self.frames, return_inverse=True)
        colours: NDArray[np.uint8] = np.stack([self._colours[frame] for frame in known])[which.reshape(-1)]
        return colours

    def heed_limits(self, limits_kmh: F64, slot: int = 0) -> None:
        """Bring the limits ``limits_kmh`` (W,), posted to the vehicles in a slot of all worlds, up to date in place.

        Off the road, in a junction and where the map posts none, the last one holds, as for the server's vehicles.

        Raises:
            UserError: the slot holds no vehicle in a world, or the array has another shape or type.
        """
        rows = self._rows(slot, self._all, VEHICLE)
        if limits_kmh.shape != (self.count,) or limits_kmh.dtype != np.float64:
            raise UserError(f"limits_kmh needs an array ({self.count},) of float64, not {_short(limits_kmh)}")
        self._read()
        if self._limit_of_lane_kmh is None:
            self._limit_of_lane_kmh = limits_of_lanes_kmh(self.map)
        position_m = self._table.state.reshape(-1)["position"]
        limits_under(self.map.ground, self.map.lane_of_triangle, self._limit_of_lane_kmh, position_m, rows, limits_kmh)

    @property
    def nbytes(self) -> int:
        """Bytes of all bodies, first states and specifications; the map's are not counted."""
        tables = (self._table, self._first)
        arrays = [array for table in tables for array in (table.state, table.spec_of, table.counts, table.specs)]
        return sum(array.nbytes for array in (*arrays, self._valid, self._frames, self._all))

    # -- checks --------------------------------------------------------------------------------------------------------

    def _keep_as_first(self, chosen: NDArray[np.int32]) -> None:
        self._first.state[chosen] = self._table.state[chosen]
        self._first.spec_of[chosen] = self._table.spec_of[chosen]
        self._table.kept = [self._first.spec_of]

    def _begin(self, chosen: NDArray[np.int32]) -> None:
        self._sensors.begin(chosen)
        self._valid[chosen], self._frames[chosen] = True, 0
        self._forget_contacts(chosen)

    def _forget_contacts(self, chosen: NDArray[np.int32]) -> None:
        contacts = self._keep_contacts()
        self._contacts = contacts[~np.isin(contacts["world"], chosen)]

    def _chosen(self, worlds: Chosen) -> NDArray[np.int32]:
        """Return the numbers of worlds (K,).

        Raises:
            UserError: they are none, or not each once.
        """
        if worlds is None:
            return self._all
        numbers = np.asarray(worlds)
        if numbers.ndim != 1 or not (numbers.size and np.issubdtype(numbers.dtype, np.integer)):
            raise UserError(f"worlds are whole numbers from 0 to {self.count - 1} in a list, not {_short(worlds)}")
        if numbers.min() < 0 or numbers.max() >= self.count:
            raise UserError(f"there are {self.count} worlds, 0 to {self.count - 1}; {_short(worlds)} names another")
        if len(np.unique(numbers)) < len(numbers):
            raise UserError(f"each world can be named once, but {_short(worlds)} repeats one")
        return numbers.astype(np.int32)

    def _rows(self, slot: int, chosen: NDArray[np.int32], kind: int = 0) -> NDArray[np.int32]:
        """Return the flat rows (K,) of a slot in worlds.

        Raises:
            UserError: in one of them the slot holds no body, or none of a kind.
        """
        slots = self._table.state.shape[1]
        _whole("slot", slot, 0, slots - 1)
        kinds = self._table.state["kind"][chosen, slot]
        wrong = np.flatnonzero((kinds == 0) if kind == 0 else (kinds != kind))
        if len(wrong):
            wanted = {VEHICLE: "vehicle", WALKER: "walker"}.get(kind, "body")
            raise UserError(f"slot {slot} of world {chosen[wrong[0]]} holds no {wanted}; spawn one first")
        return chosen * np.int32(slots) + np.int32(slot)

    def _poses(self, at: int | ArrayLike, count: int) -> F64:
        """Return poses (K, 6) of numbers of spawn points, or of poses.

        Raises:
            UserError: they are neither.
        """
        given = np.asarray(at)
        if np.issubdtype(given.dtype, np.integer) and given.ndim < 2 and given.shape != (6,):
            points = self.map.spawn_points
            if not points:
                raise UserError(f"map {self.map.name} has no spawn points; give poses of x, y, z, pitch, yaw, roll")
            if given.shape not in {(), (count,)}:
                raise UserError(f"at needs one spawn point or {count}, not an array of shape {given.shape}")
            if given.min() < 0 or given.max() >= len(points):
                raise UserError(f"map {self.map.name} has spawn points 0 to {len(points) - 1}; choose one of them")
            table = np.array([[*point.location, *point.rotation] for point in points])
            return np.broadcast_to(table[given], (count, 6)).copy()
        return _numbers("a pose (x, y, z, pitch, yaw, roll)", given, (count, 6))

    def _refuse_deep(self, poses: F64) -> None:
        """Refuse poses far below the ground: the server takes a body there out of the physics.

        Raises:
            UserError: one is.
        """
        heights_m, _ = self.map.ground.surfaces_under(poses[:, :3])
        deep = np.flatnonzero(poses[:, 2] < heights_m - DEEP_M)
        if len(deep):
            at = ", ".join(f"{value:.2f}" for value in poses[deep[0], :3])
            raise UserError(f"({at}) lies more than {DEEP_M:.0f} m below the ground at {heights_m[deep[0]]:.2f} m")

    def _refuse_without_room(
        self, blueprint: Blueprint, poses: list[Transform], chosen: NDArray[np.int32], pose_of_world: NDArray[np.intp]
    ) -> None:
        """Raise UserError where a body or the scenery stands at a pose, as the server refuses to spawn there."""
        statics = self._scenery.statics
        for number, pose in enumerate(poses):
            mine = chosen[pose_of_world == number]
            scenery = scenery_at(statics, blueprint.box, pose)
            if scenery is not None:
                self._refuse_room(blueprint, pose, int(mine[0]), scenery)
            met = bodies_at(self._table.state[mine].reshape(-1), blueprint.box, pose)
            if len(met):
                world, slot = divmod(int(met[0]), self._table.state.shape[1])
                self._refuse_room(blueprint, pose, int(mine[world]), f"the body in slot {slot}")

    def _refuse_room(self, blueprint: Blueprint, pose: Transform, world: int, other: str) -> None:
        at = ", ".join(f"{value:.2f}" for value in pose.location)
        raise UserError(f"{blueprint.definition.id} has no room at ({at}) in world {world}: {other} stands there")


def _gpu(ground: Ground, statics: Statics) -> "GpuWorlds":
    """Return worlds on a GPU.

    Raises:
        UserError: numba-cuda is missing, or there is no device.
    """
    try:
        from linden.worlds_gpu import GpuWorlds  # noqa: PLC0415 - numba-cuda is of the extra gpu
    except ImportError as error:
        raise UserError(f"device='cuda' needs the extra gpu: pip install 'linden[gpu]' ({error})") from error
    return GpuWorlds(ground, statics)


def _whole(name: str, value: object, least: int, most: int) -> int:
    """Return a whole number.

    Raises:
        UserError: it is none, or outside its limits.
    """
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)) or not least <= value <= most:
        raise UserError(f"{name} is a whole number from {least} to {most}, not {_short(value)}")
    return int(value)


def _numbers(name: str, value: ArrayLike, shape: tuple[int, ...]) -> F64:
    """Return finite numbers of a shape; one row stands for all.

    Raises:
        UserError: the shape or the type is another, or a number is not finite.
    """
    given = np.asarray(value)
    if given.dtype.kind not in "biuf":
        raise UserError(f"{name} must be numbers, not {given.dtype}")
    if given.shape not in {shape, shape[1:]}:
        raise UserError(f"{name} needs the shape {shape} or {shape[1:]}, not {given.shape}")
    found = np.broadcast_to(given.astype(np.float64), shape)
    if not np.isfinite(found).all():
        place = tuple(int(axis[0]) for axis in np.nonzero(~np.isfinite(found)))
        raise UserError(f"{name} must be finite; at {place} it is {found[place]}")
    return np.ascontiguousarray(found)


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
