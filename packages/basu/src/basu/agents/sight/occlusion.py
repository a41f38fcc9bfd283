"""Rays against upright boxes: which bodies are hidden behind houses, trees, parked cars and other bodies.

All arrays are in CARLA's frame, m and rad. Boxes stand upright: they turn about the vertical only.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import carla
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

# Buildings, Walls, … : names of carla.CityObjectLabel. Poles and signs are too thin to hide a body.
HIDING_LABELS = ("Buildings", "Fences", "Walls", "GuardRail", "Vegetation", "Car", "Truck", "Bus", "Train", "Static")
LEAST_HALF_M = 0.15  # least half width of a blocking box: a thinner thing hides no actor
CROWN_HALF_M = 2.0  # a wider box of vegetation is a crown, which one looks through under and beside its leaves
SAMPLES = np.array(  # of a body's box, as shares of its half sides: below the top, the middle, four corners
    [(0.0, 0.0, 0.9), (0.0, 0.0, 0.0), (0.8, 0.8, 0.2), (0.8, -0.8, 0.2), (-0.8, 0.8, 0.2), (-0.8, -0.8, 0.2)]
)
TOUCH_M = 0.01
REGION_M = 10.0  # static boxes near the sensor are chosen anew after so much way


class Boxes(NamedTuple):
    """N upright boxes."""

    centre_m: NDArray[np.float64]  # (N, 3)
    half_m: NDArray[np.float64]  # (N, 3) half length, half width, half height
    cos: NDArray[np.float64]  # (N,) of the yaw
    sin: NDArray[np.float64]  # (N,)
    radius_m: NDArray[np.float64]  # (N,) of the circle around the box, seen from above

    def of(self, chosen: NDArray[np.bool_] | NDArray[np.intp]) -> Boxes:
        """Return some of the boxes."""
        return Boxes(*(column[chosen] for column in self))

    def and_(self, others: Boxes) -> Boxes:
        """Return these boxes, then the others."""
        return Boxes(*(np.concatenate(pair) for pair in zip(self, others, strict=True)))


def make_boxes(rows: NDArray[np.float64]) -> Boxes:
    """Return boxes from rows of x, y, z, half length, half width, half height, yaw: (N, 7)."""
    half_m, yaw_rad = rows[:, 3:6], rows[:, 6]
    return Boxes(rows[:, :3], half_m, np.cos(yaw_rad), np.sin(yaw_rad), np.hypot(half_m[:, 0], half_m[:, 1]))


def sample_points_m(bodies: Boxes, samples: NDArray[np.float64] = SAMPLES) -> NDArray[np.float64]:
    """Return the points of each body that rays are sent to: (N, P, 3)."""
    own = samples[None] * bodies.half_m[:, None, :]
    points = np.empty_like(own)
    points[..., 0] = own[..., 0] * bodies.cos[:, None] - own[..., 1] * bodies.sin[:, None]
    points[..., 1] = own[..., 0] * bodies.sin[:, None] + own[..., 1] * bodies.cos[:, None]
    points[..., 2] = own[..., 2]
    return points + bodies.centre_m[:, None, :]


def hidden(sensor_m: NDArray[np.float64], bodies: Boxes, boxes: Boxes) -> NDArray[np.bool_]:
    """Return for each body whether every ray from the sensor to its sample points is blocked: (N,).

    A box blocks a ray that enters and leaves it on the way. So neither the body itself nor a box around the sensor or
    around the body blocks. Most bodies in sight show their first point: only where it is blocked are the others tried.

    Args:
        sensor_m: (3,) where the rays begin.
        bodies: what is looked at.
        boxes: what may stand in between; may hold the bodies.
    """
    body, box = _candidates(sensor_m, bodies, boxes)
    hides = np.zeros(len(bodies.cos), dtype=np.bool_)
    hides[body[_pass_through(sensor_m, bodies, boxes, body, box, SAMPLES[:1])[:, 0]]] = True
    again = hides[body]
    body, box = body[again], box[again]
    if len(body):
        blocked = np.zeros((len(hides), len(SAMPLES) - 1), dtype=np.bool_)
        pair, sample = np.nonzero(_pass_through(sensor_m, bodies, boxes, body, box, SAMPLES[1:]))
        blocked[body[pair], sample] = True
        hides &= blocked.all(axis=1)
    return hides


def _candidates(
    sensor_m: NDArray[np.float64], bodies: Boxes, boxes: Boxes
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return pairs of a body and a box: seen from above, the box's circle touches the fan of rays to the body."""
    to_body, to_box = bodies.centre_m[:, :2] - sensor_m[:2], boxes.centre_m[:, :2] - sensor_m[:2]
    away_m = np.maximum(np.hypot(to_body[:, 0], to_body[:, 1]), 1e-6)
    ahead = to_body / away_m[:, None]
    # single precision is enough to choose, and takes half the time; TOUCH_M is more than it loses
    east, north, radius_m = (column.astype(np.float32) for column in (to_box[:, 0], -to_box[:, 1], boxes.radius_m))
    aside_m = np.multiply.outer(ahead[:, 1].astype(np.float32), east)
    aside_m += np.multiply.outer(ahead[:, 0].astype(np.float32), north)  # (N, M) of the box's centre beside the ray …
    np.abs(aside_m, out=aside_m)
    aside_m -= radius_m
    body, box = np.divmod(
        np.flatnonzero(aside_m < (bodies.radius_m + TOUCH_M).astype(np.float32)[:, None]), max(len(to_box), 1)
    )
    along_m = (ahead[body] * to_box[box]).sum(axis=1)  # … and along it
    reach_m = boxes.radius_m[box]
    between = (along_m > -reach_m) & (along_m - reach_m < away_m[body])
    return body[between], box[between]


def _pass_through(
    sensor_m: NDArray[np.float64],
    bodies: Boxes,
    boxes: Boxes,
    body: NDArray[np.intp],
    box: NDArray[np.intp],
    samples: NDArray[np.float64],
) -> NDArray[np.bool_]:
    """Return for K pairs whether the rays to P points of the body enter and leave the box on the way: (K, P).

    Slabs: Kay and Kajiya 1986, "Ray Tracing Complex Scenes".
    """
    points_m = sample_points_m(bodies, samples)[body] - boxes.centre_m[box][:, None, :]
    start_m = (sensor_m - boxes.centre_m[box])[:, None, :]
    cos, sin, half_m = boxes.cos[box][:, None], boxes.sin[box][:, None], boxes.half_m[box]
    enters, leaves = np.zeros(points_m.shape[:2]), np.ones(points_m.shape[:2])
    for axis, (along, across) in enumerate(((cos, sin), (-sin, cos))):
        begin = start_m[..., 0] * along + start_m[..., 1] * across
        end = points_m[..., 0] * along + points_m[..., 1] * across
        _clip(begin, end, half_m[:, axis, None], enters, leaves)
    _clip(start_m[..., 2], points_m[..., 2], half_m[:, 2, None], enters, leaves)
    return np.asarray((enters < leaves) & (enters > 0.0) & (leaves < 1.0))


def _clip(
    begin_m: NDArray[np.float64],
    end_m: NDArray[np.float64],
    half_m: NDArray[np.float64],
    enters: NDArray[np.float64],
    leaves: NDArray[np.float64],
) -> None:
    """Narrow the shares of the way that lie inside a box to those inside one of its slabs, in place."""
    inverse = 1.0 / (end_m - begin_m + 1e-12)
    middle, reach = -begin_m * inverse, half_m * np.abs(inverse)
    np.maximum(enters, middle - reach, out=enters)
    np.minimum(leaves, middle + reach, out=leaves)


class StaticBoxes:
    """The boxes of a town's houses, fences, trunks and parked cars, and those of them near the sensor."""

    def __init__(self, boxes: Boxes) -> None:
        self._boxes = boxes
        self._near = boxes.of(np.zeros(0, dtype=np.intp))
        self._chosen_at_m: NDArray[np.float64] | None = None
        self._within_m = 0.0

    def near(self, sensor_m: NDArray[np.float64], within_m: float) -> Boxes:
        """Return at least those boxes that reach into a circle around the sensor."""
        at_m = self._chosen_at_m
        if at_m is None or within_m > self._within_m or np.abs(sensor_m[:2] - at_m).max() > REGION_M:
            off_m = self._boxes.centre_m[:, :2] - sensor_m[:2]
            reach_m = within_m + 1.5 * REGION_M + self._boxes.radius_m
            self._near = self._boxes.of(np.hypot(off_m[:, 0], off_m[:, 1]) < reach_m)
            self._chosen_at_m, self._within_m = sensor_m[:2].copy(), within_m
        return self._near


_BOXES_OF_TOWN: dict[int, Boxes] = {}  # of the last town, by a hash of its objects' names


def static_boxes(world: carla.World) -> StaticBoxes:
    """Return what stands beside a town's streets; asks the server once per town and process."""
    key = hash(tuple(world.get_names_of_all_objects()))
    if key not in _BOXES_OF_TOWN:
        rows = [row for name in HIDING_LABELS for row in _rows(world, name)]
        _BOXES_OF_TOWN.clear()
        _BOXES_OF_TOWN[key] = make_boxes(np.array(rows, dtype=np.float64).reshape(-1, 7))
    return StaticBoxes(_BOXES_OF_TOWN[key])


def _rows(world: carla.World, label: str) -> list[tuple[float, ...]]:
    """Return the boxes of one label that are large enough to hide a body."""
    rows: list[tuple[float, ...]] = []
    crown_m = CROWN_HALF_M if label == "Vegetation" else np.inf
    for thing in world.get_environment_objects(getattr(carla.CityObjectLabel, label)):  # without spawned actors
        box = thing.bounding_box
        at, half = box.location, box.extent
        if max(half.x, half.y) >= LEAST_HALF_M and min(half.x, half.y) < crown_m:
            rows.append((at.x, at.y, at.z, half.x, half.y, half.z, np.radians(box.rotation.yaw)))
    return rows
