"""Buffers in GPU memory: rays and light of one camera, the state kept between pictures, the inputs of a frame.

The inputs of a frame and of a picture are packed into one array each, so that each takes one transfer.
"""

from collections.abc import Callable, Hashable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from linden.geometry import rotation_matrix
from linden.protocol.values.space import Transform
from linden.sensors.camera import optical_flow as motion
from linden.sensors.camera.labels import FAR_M
from linden.sensors.camera.picture import film as develop
from linden.sensors.camera.picture.atmosphere import Air
from linden.sensors.camera.picture.edges import SAMPLES
from linden.sensors.camera.picture.rgb import Light
from linden.sensors.camera.picture.sun_shadows import LONGEST_SHADOW_M
from linden.sensors.camera.picture.surface_points import Places
from linden.sensors.camera.pixel_rays import directions, pixel_of_ray
from linden.sensors.camera.spec import CameraSpec, Film
from linden.sensors.casting.caster import Hits, Rays
from linden.sensors.casting.gpu_memory import Gpu, UploadBuffer
from linden.sensors.casting.warp_caster import DeviceRays, WarpCaster
from linden.sensors.view import Seen, SensorLook, first_of_places, id_of_places


class RayBuffers:
    """Arrays of numba's for up to ``room`` rays; ``asked`` (1,) says how many they are, on the device too."""

    def __init__(self, caster: WarpCaster, gpu: Gpu, room: int) -> None:
        self._caster, self._gpu = caster, gpu
        self.room = room
        self.asked = gpu.put(np.array([room], np.int32))
        self.rays = Rays(*(gpu.empty((room, 3), np.float32) for _ in range(2)))
        self.hits = Hits(
            gpu.empty((room,), np.float32),
            gpu.empty((room,), np.int32),
            gpu.empty((room,), np.int32),
            gpu.empty((room, 3), np.float32),
        )
        self.facing, self.sunny = gpu.empty((room,), np.bool_), gpu.empty((room,), np.float32)
        self.to_sun = Rays(*(gpu.empty((room, 3), np.float32) for _ in range(2)))
        self.light = gpu.empty((room, 3), np.float32)
        count = gpu.view(self.asked)
        self._questions = [DeviceRays(room, [gpu.view(a) for a in rays], count) for rays in (self.rays, self.to_sun)]
        self._hits = [gpu.view(a) for a in self.hits]
        self._masks = [gpu.view(self.facing), gpu.view(self.sunny)]

    def cast(self) -> None:
        """Find what the rays meet; they go out through the inner sides of bodies."""
        self._caster.closest_into(self._questions[0], self._hits, FAR_M, self._gpu)

    def cast_to_sun(self) -> None:
        """Find which of what faces the sun it reaches."""
        self._caster.sunny_into(self._questions[1], self._masks, LONGEST_SHADOW_M, self._gpu)


_EDGES = 6
"""One in so many pixels gets its samples at once; where more are edges, the others follow, lot after lot."""


class ConstantBuffers:
    """Arrays on a GPU that stay as they are, by what they are for."""

    def __init__(self, gpu: Gpu) -> None:
        self._gpu = gpu
        self._kept: dict[Hashable, Any] = {}

    def kept(self, key: Hashable, make: Callable[[], NDArray[Any]]) -> Any:  # noqa: ANN401 - an array of numba's
        """Return the GPU's copy of an array, made once; for what there is one of for each kind of camera."""
        if key not in self._kept:
            self._kept[key] = self._gpu.put(make())
        return self._kept[key]

    def directions(self, spec: CameraSpec) -> Any:  # noqa: ANN401 - an array of numba's
        """Return (N, 3): see ``rays.directions``."""
        return self.kept(("directions", spec), lambda: directions(spec))

    def pixel(self, spec: CameraSpec) -> Any:  # noqa: ANN401 - an array of numba's
        """Return (N,): see ``rays.pixel_of_ray``."""
        return self.kept(("pixel", spec), lambda: pixel_of_ray(spec))

    def numbers(self, count: int) -> Any:  # noqa: ANN401 - an array of numba's
        """Return 0, 1, 2, ... up to ``count`` at least."""
        enough = 1 << max(count - 1, 1).bit_length()
        return self.kept(("numbers", enough), lambda: np.arange(enough, dtype=np.int64))


class ViewBuffers:
    """For one view in a frame, and for another one of the same size and lens in the next.

    Attributes:
        gpu: the device, for work that does not wait for that of other views.
        ray_buffers: its rays.
        fine: more rays of some of its pixels.
    """

    def __init__(self, caster: WarpCaster, spec: CameraSpec) -> None:
        self.gpu, self._caster = caster.gpu.beside(), caster
        count = len(directions(spec))
        self.ray_buffers = RayBuffers(caster, self.gpu, count)
        self.fine = RayBuffers(caster, self.gpu, SAMPLES * -(-count // _EDGES))
        self._scratch: dict[str, Any] = {}
        self._boxes: dict[str, UploadBuffer] = {}
        self._captured: dict[Hashable, Any] = {}
        self._captured_for: tuple[int, ...] = ()

    def scratch(self, name: str, shape: tuple[int, ...], dtype: DTypeLike) -> Any:  # noqa: ANN401 - an array of numba's
        """Return an array that holds its values until the next picture."""
        if name not in self._scratch:
            self._scratch[name] = self.gpu.empty(shape, dtype)
        return self._scratch[name]

    def sent(self, box: str, inputs: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return arrays on the GPU, at the same place as those sent before under the name of this box."""
        if box not in self._boxes:
            self._boxes[box] = UploadBuffer(self.gpu)
        return self._boxes[box].send(inputs)

    def run(self, key: Hashable, moves: int, work: Callable[[], None]) -> None:
        """Do ``work``, which only launches kernels on arrays that stay where they are; ``key`` says which work.

        The first time it is done as it stands, which compiles and loads what it needs. The second time what it
        launches is captured, and from then on launched by one call: launching from Python takes longer than most
        kernels run. ``moves`` changes when arrays of others lie elsewhere.
        """
        valid_for = (self._caster.trees, moves, *(box.moves for box in self._boxes.values()))
        if valid_for != self._captured_for:
            self._captured, self._captured_for = dict.fromkeys(self._captured), valid_for
        if key not in self._captured:
            self._captured[key] = None
            work()
            return
        if self._captured[key] is None:
            self._captured[key] = self.gpu.capture(work)
        self.gpu.replay(self._captured[key])


Inputs = dict[str, NDArray[Any]]
Array = Any
"""An array of numba's on the GPU."""

AIR = np.dtype([(name, "f4") if kind is float else (name, "f4", 3) for name, kind in Air.__annotations__.items()])
"""``Air`` as the GPU has it."""


class ViewLights(NamedTuple):
    """What lights a view, as the GPU has it; see ``rgb.Light``."""

    places: Places
    sun: Array  # (3,)
    air: Array  # (1,) of AIR
    corner: Array  # (2,) of the grid of lamps
    lamps: tuple[Array, Array, Array]
    factor: Array  # (3,)
    rain: Array  # (3,)
    view: Array  # (3, 4)


def of_light(light: Light, film: Film, pose: Transform) -> Inputs:
    """Return what lights a view, and what a film makes of it."""
    air, grid = light.air, light.lamps
    return {
        "sun": np.array([air.sun_x, air.sun_y, air.sun_z], np.float32),
        "air": np.array([tuple(air)], AIR),
        "corner": np.array([grid.west_m, grid.north_m], np.float32),
        "first": grid.first,
        "number": grid.number,
        "lamps": grid.lamps,
        "factor": develop.balance(film, air),
        "rain": np.array(develop.rain(air), np.float64),
        "view": posed(pose),
    }


def lit(places: Places, sent: dict[str, Array]) -> ViewLights:
    """Return what ``of_light`` has become on the GPU."""
    lamps = sent["first"], sent["number"], sent["lamps"]
    return ViewLights(
        places, lamps=lamps, **{name: sent[name] for name in ("sun", "air", "corner", "factor", "rain", "view")}
    )


def of_owners(seen: Seen) -> Inputs:
    """Return the first face and the actor of each place, and the id of each object."""
    return {
        "first": first_of_places(seen.faces, seen.instances),
        "actor_id": id_of_places(seen.instances),
        "object_id": seen.object_id,
    }


def of_motion(look: SensorLook) -> Inputs:
    """Return where bodies and the camera came from."""
    before, now = motion.eye(look.before), motion.eye(look.pose)
    return {
        "carried": motion.carried_back(look.seen.instances),
        "places_m": np.array([before.place_m, now.place_m]),
        "turns": np.array([before.turn, now.turn]),
    }


def posed(pose: Transform) -> NDArray[np.float32]:
    """Return (3, 4): how a camera is turned, and where it is."""
    return np.column_stack([rotation_matrix(pose.rotation), pose.location]).astype(np.float32)
