"""Points of a lidar's sweep, written as CARLA sends them, in one pass over the hits of its rays."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel
from linden.sensors.casting.caster import Hits
from linden.sensors.devices.lidar.firing_pattern import Fired
from linden.structured import StructuredArray

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]
U32 = NDArray[np.uint32]

SEMANTIC_POINT = np.dtype([("xyz", "<f4", (3,)), ("cos_incidence", "<f4"), ("object_id", "<u4"), ("tag", "<u4")])
"""A detection of the semantic lidar: m in the sensor's frame, 0 to 1, the actor's id or 0, values.enums.SemanticTag."""


class Sweep(NamedTuple):
    """What a lidar measured: points channel by channel, the uppermost first."""

    horizontal_rad: float  # where the next sweep begins
    points_of_channel: U32  # (channels,)
    points: F32  # (N, 4): x, y, z in the sensor's frame, m, and the intensity from 0 to 1


class SemanticSweep(NamedTuple):
    """What a semantic lidar measured, likewise."""

    horizontal_rad: float
    points_of_channel: U32
    points: StructuredArray  # (N,) of SEMANTIC_POINT


class Losses(NamedTuple):
    """What a lidar misses, and how it errs; see CARLA's manual."""

    attenuation_per_m: float
    general_rate: float
    intensity_limit: float
    zero_intensity: float
    deviation_m: float
    seed: int

    @property
    def limit(self) -> float:
        """Intensity up to which returns get lost by chance; 0 where none does."""
        return self.intensity_limit if self.zero_intensity > 0.0 else 0.0

    @property
    def by_chance(self) -> bool:
        """Whether points get lost or move by chance."""
        return self.general_rate > 0.0 or self.deviation_m > 0.0 or self.limit > 0.0


class Chances(NamedTuple):
    """What the dice say of each ray (N,): from 0 to 1, and how far off its distance is, m."""

    loss: F32
    error_m: F32


def points_of(fired: Fired, number: I32, distance_m: F32, losses: Losses, chances: Chances) -> tuple[U32, F32, I32]:
    """Return how many points each channel has, the points (M, 4), and the number (M,) of the ray of each.

    Args:
        fired: the rays of the sweep.
        number: (N,) which of them were cast.
        distance_m: (N,) to what they met, infinite where they met nothing.
        losses: what the lidar misses.
        chances: what the dice say of each ray that was cast.
    """
    count, points = np.zeros(len(fired.up), np.uint32), np.empty((len(number), 4), np.float32)
    kept = np.empty(len(number), np.int32)
    limit = losses.limit
    alpha = losses.zero_intensity / limit if limit > 0.0 else 0.0
    rates = np.array([losses.attenuation_per_m, limit, alpha, 1.0 - losses.zero_intensity], np.float32)
    made = _write(*fired, number, distance_m, rates, *chances, count, points, kept)
    return count, points[:made], kept[:made]


@kernel
def _write(
    up: F32,
    level: F32,
    cosine: F32,
    sine: F32,
    number: I32,
    distance: F32,
    rates: F32,
    loss: F32,
    error: F32,
    count: U32,
    points: F32,
    kept: I32,
) -> int:  # pragma: no cover - compiled
    made = 0
    for ray in range(len(number)):
        if not np.isfinite(distance[ray]):
            continue
        intensity = np.exp(-rates[0] * distance[ray])
        if intensity <= rates[1] and loss[ray] >= rates[2] * intensity + rates[3]:
            continue
        channel, step = number[ray] // len(sine), number[ray] % len(sine)
        away = distance[ray] + error[ray]
        points[made, 0] = away * level[channel] * cosine[step]
        points[made, 1] = away * level[channel] * sine[step]
        points[made, 2] = away * up[channel]
        points[made, 3] = intensity
        kept[made] = number[ray]
        count[channel] += np.uint32(1)
        made += 1
    return made


class Owners(NamedTuple):
    """The actor or object of each face; see ``linden.sensors.view``."""

    first: NDArray[np.int64]  # (1 + K,) the first face of each place
    actor: U32  # (1 + K,)
    tag: NDArray[np.uint8]  # of each face
    thing: I32  # of each face
    actor_of_thing: U32  # the last for what is no thing


def semantic_points_of(fired: Fired, direction: F32, hits: Hits, owners: Owners) -> tuple[U32, StructuredArray]:
    """Return how many points each channel has, and the points (M,) of SEMANTIC_POINT; all rays are cast."""
    count, points = np.zeros(len(fired.up), np.uint32), np.empty(len(direction), SEMANTIC_POINT)
    columns = points.view(np.float32).reshape(-1, 6)
    first, actor, tag, thing, actor_of_thing = owners
    made = _write_semantic(
        *fired, direction, *hits, first, actor, tag, thing, actor_of_thing, count, columns, columns.view(np.uint32)
    )
    return count, points[:made]


@kernel
def _write_semantic(
    up: F32,
    level: F32,
    cosine: F32,
    sine: F32,
    direction: F32,
    distance: F32,
    instance: I32,
    triangle: I32,
    normal: F32,
    first: NDArray[np.int64],
    actor: U32,
    tag: NDArray[np.uint8],
    thing: I32,
    actor_of_thing: U32,
    count: U32,
    reals: F32,
    words: U32,
) -> int:  # pragma: no cover - compiled
    made = 0
    for ray in range(len(direction)):
        if not np.isfinite(distance[ray]):
            continue
        channel, step, away = ray // len(sine), ray % len(sine), distance[ray]
        reals[made, 0] = away * level[channel] * cosine[step]
        reals[made, 1] = away * level[channel] * sine[step]
        reals[made, 2] = away * up[channel]
        d, n = direction[ray], normal[ray]
        reals[made, 3] = min(np.float32(1.0), abs(d[0] * n[0] + d[1] * n[1] + d[2] * n[2]))
        place = instance[ray] + 1
        face = first[place] + triangle[ray]
        words[made, 4] = actor[place] if place > 0 else actor_of_thing[thing[face]]
        words[made, 5] = tag[face]
        count[channel] += np.uint32(1)
        made += 1
    return made
