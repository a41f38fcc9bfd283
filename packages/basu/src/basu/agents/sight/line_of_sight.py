"""The line-of-sight filter: the actors that a vehicle's sensors see by range, light and weather, with a memory.

By day light sets no limit. From sunset on, lamps are needed: Ohio Revised Code 4513.03 (A) demands them from sunset,
and wherever persons are not discernible at 1,000 feet. For drivers twilight ends at a sun 6° below the horizon (civil
twilight: from some 500 lx to 3 lx, AMS Glossary of Meteorology). By then an unlit body is seen in the low beams only.
They have to reveal persons at 100 feet (Ohio Administrative Code 4501-15, (C)(2)): the least that a lawful lamp does.
Vehicles have lamps or reflectors, which have to be visible from 500 feet (Ohio Revised Code 4513.05, 4511.56).

In fog, rain and dust the range is the meteorological optical range: contrast falls to 5 % after 3 / extinction
(Koschmieder; WMO-No. 8, part I, chapter 9). CARLA gives its fog density no unit. The extinction here is that of
Linden's pictures (0.07/m in the densest fog, so 43 m), for want of a published one.

The sensors sit on the roof, at its front edge: on the shuttle 2.9 m above the road, on a car 1.5 m. They look all
round. A body is seen where one of the rays to several points of its box is free, within the range of light and weather.
The ground hides nothing: a crest between two actors is not looked for.
"""

from __future__ import annotations

import enum
import math
from typing import TYPE_CHECKING

import numpy as np

from basu.agents.sight.actors import ActorKind, Census, Other
from basu.agents.sight.occlusion import hidden, make_boxes, static_boxes

if TYPE_CHECKING:
    from collections.abc import Collection

    import carla
    from numpy.typing import NDArray

    from basu.agents.sight.occlusion import StaticBoxes
    from basu.records.partners import Partner


FOOT_M = 0.3048
SUNSET_M = 1000.0 * FOOT_M  # of an unlit body, as the sun sets
LOW_BEAM_M = 100.0 * FOOT_M  # of an unlit body, in the dark
LAMPS_M = 500.0 * FOOT_M  # of a vehicle, in the dark
DARK_DEG = -6.0  # height of the sun
CONTRAST = 0.05  # at which a thing cannot be seen against the fog
FOG_PER_M, FOG_EXPONENT = 0.07, 1.6  # extinction in the densest fog; how it grows with the density
RAIN_PER_M, DUST_PER_M = 0.003, 0.03  # in the hardest rain and the densest dust
CLEAR_PER_M = 1e-4  # 30 km


def light_range_m(sun_altitude_deg: float, *, lamps: bool) -> float:
    """Return how far a body is seen by the light there is; inf by day.

    Args:
        sun_altitude_deg: height of the sun above the horizon.
        lamps: whether the body has lamps or reflectors, as vehicles have.
    """
    if sun_altitude_deg >= 0.0:
        return math.inf
    dark_m = LAMPS_M if lamps else LOW_BEAM_M
    if sun_altitude_deg <= DARK_DEG:
        return dark_m
    share = sun_altitude_deg / DARK_DEG  # of the way from sunset into the dark
    return float(SUNSET_M * (dark_m / SUNSET_M) ** share)  # light falls by the same factor with each degree


def air_range_m(weather: carla.WeatherParameters) -> float:
    """Return the meteorological optical range, behind the distance at which CARLA's fog begins."""
    fog, rain, dust = (_share(v) for v in (weather.fog_density, weather.precipitation, weather.dust_storm))
    per_m = CLEAR_PER_M + FOG_PER_M * fog**FOG_EXPONENT + RAIN_PER_M * rain + DUST_PER_M * dust
    return float(max(0.0, float(weather.fog_distance)) - math.log(CONTRAST) / per_m)


def ranges_m(weather: carla.WeatherParameters) -> tuple[float, float]:
    """Return how far an unlit body is seen in this weather, and how far a vehicle."""
    if weather.cloudiness < 0.0:
        return math.inf, math.inf  # the map's own weather (CARLA's preset Default): a clear day
    air_m, sun_deg = air_range_m(weather), float(weather.sun_altitude_angle)
    return min(air_m, light_range_m(sun_deg, lamps=False)), min(air_m, light_range_m(sun_deg, lamps=True))


def _share(percent: float) -> float:
    return min(1.0, max(0.0, float(percent) / 100.0))


RADIUS_M = 80.0  # farther actors do not matter in a town: 11 m/s through the longest gap that is waited for
MEMORY_S = 2.0  # a driver counts on an actor for so long after it went out of sight
NEAR_M = 120.0  # static boxes are kept for this circle, and for the whole radius once an actor is farther away
FAR_TICKS = 5  # beyond ``RADIUS_M`` an actor is looked at in every fifth tick, four times a second
WEATHER_TICKS = 20  # the weather is read again after so many ticks


class Knowledge(enum.Enum):
    """What a built-in agent knows of others."""

    SEEN = "seen"  # those in line of sight, and those seen a moment ago
    FULL = "full"  # all, as the simulator has them
    NONE = "none"  # no other actor: for the control drivers


class Sight:
    """Sees for one vehicle. One object a run: it remembers.

    The static objects of the town are fetched from the server once per process, when the first actor is near.
    """

    def __init__(
        self,
        world: carla.World,
        vehicle: carla.Vehicle,
        radius_m: float = RADIUS_M,
        knowledge: Knowledge = Knowledge.SEEN,
        blind_to: Collection[Partner] = (),
    ) -> None:
        """Look from a vehicle.

        Args:
            world: with the vehicle in it.
            vehicle: the sensors sit on its roof.
            radius_m: actors farther than this along x or y are left out.
            knowledge: ``FULL`` leaves the filter out; ``NONE`` sees no actor.
            blind_to: actors of these kinds are left out; they hide others all the same.
        """
        self._world, self._own_id, self._radius_m, self._knowledge = world, vehicle.id, radius_m, knowledge
        self._census = Census(world, vehicle.id, radius_m)
        self._blind_to = frozenset(blind_to)
        box = vehicle.bounding_box
        self._ahead_m = float(box.location.x + box.extent.x)
        self._above_m = float(box.location.z + box.extent.z)
        self._static: StaticBoxes | None = None
        self._seen: dict[int, tuple[float, Other]] = {}  # when and how each was last seen
        self._saw: dict[int, bool] = {}  # whether each was in sight when it was last looked at
        self._turns: dict[int, int] = {}  # by when each was first met
        self._ranges_m = (math.inf, math.inf)  # of unlit bodies, and of vehicles
        self._tick, self._weather_tick = 0, -WEATHER_TICKS

    def others(self, snapshot: carla.WorldSnapshot | None = None) -> list[Other]:
        """Return the actors that are seen in a snapshot (the world's latest) or were a moment ago, in its order.

        Call it once a tick. Positions are in CARLA's world frame, m and rad; see :class:`Other`.
        """
        snapshot = self._world.get_snapshot() if snapshot is None else snapshot
        own = snapshot.find(self._own_id)
        if own is None or self._knowledge is Knowledge.NONE:
            return []  # None: before the vehicle's first tick
        pose = own.get_transform()
        found = self._census.near(snapshot, pose.location.x, pose.location.y)
        known = found
        if self._knowledge is not Knowledge.FULL:
            known = self._remembered(found, self._visible(found, pose), snapshot.timestamp.elapsed_seconds)
        if not self._blind_to:
            return known
        return [other for other in known if self._census.partner(other.id) not in self._blind_to]

    def _visible(self, found: list[Other], pose: carla.Transform) -> list[bool]:
        """Return for each actor whether it is in sight."""
        self._tick += 1
        if not found:
            return []
        if self._tick >= self._weather_tick + WEATHER_TICKS:
            self._ranges_m, self._weather_tick = ranges_m(self._world.get_weather()), self._tick
        if self._static is None:
            self._static = static_boxes(self._world)
        sensor_m = self._sensor_m(pose)
        rows = np.array(
            [(o.x_m, o.y_m, o.z_m, o.half_length_m, o.half_width_m, o.half_height_m, o.yaw_rad) for o in found]
        )
        bodies = make_boxes(rows)
        away_m = np.hypot(rows[:, 0] - sensor_m[0], rows[:, 1] - sensor_m[1])
        unlit_m, lamps_m = self._ranges_m
        reach_m = np.array([lamps_m if o.kind is ActorKind.VEHICLE else unlit_m for o in found]) + bodies.radius_m
        due = np.array([self._is_due(o.id, far) for o, far in zip(found, (away_m > RADIUS_M).tolist(), strict=True)])
        looked_at = np.flatnonzero(due & (away_m <= reach_m))
        visible = np.array([self._saw.get(o.id, False) for o in found]) & ~due
        if len(looked_at):
            farthest_m = float(away_m[looked_at].max())
            within_m = NEAR_M if farthest_m < NEAR_M else math.hypot(self._radius_m, self._radius_m)
            boxes = self._static.near(sensor_m, within_m).and_(bodies)
            visible[looked_at] = ~hidden(sensor_m, bodies.of(looked_at), boxes)
        verdicts: list[bool] = visible.tolist()
        self._saw = {other.id: verdict for other, verdict in zip(found, verdicts, strict=True)}
        return verdicts

    def _sensor_m(self, pose: carla.Transform) -> NDArray[np.float64]:
        """Return where the sensors are: (3,), at the middle of the roof's front edge."""
        at, ahead, up = pose.location, pose.get_forward_vector(), pose.get_up_vector()
        axes = ((at.x, ahead.x, up.x), (at.y, ahead.y, up.y), (at.z, ahead.z, up.z))
        return np.array([origin + self._ahead_m * a + self._above_m * u for origin, a, u in axes])

    def _is_due(self, actor_id: int, far: bool) -> bool:  # noqa: FBT001 - one of two
        """Return whether to look at an actor in this tick: always at near ones, in turn at far ones."""
        turn = self._turns.setdefault(actor_id, len(self._turns))  # no id decides: ids differ from run to run
        return not far or actor_id not in self._saw or (turn + self._tick) % FAR_TICKS == 0

    def _remembered(self, found: list[Other], visible: list[bool], time_s: float) -> list[Other]:
        """Return those in sight, and those seen a moment ago where they would be by now."""
        known, seen = [], {}
        for other, sees in zip(found, visible, strict=True):
            if sees:
                seen[other.id] = (time_s, other)
                known.append(other)
            elif other.id in self._seen:
                at_s, last = self._seen[other.id]
                if time_s - at_s <= MEMORY_S:
                    seen[other.id] = (at_s, last)
                    known.append(_extrapolated(last, time_s - at_s))
        self._seen = seen
        return known


def _extrapolated(last: Other, unseen_s: float) -> Other:
    """Return an actor as it would be after driving or walking straight on."""
    return last._replace(
        x_m=last.x_m + unseen_s * last.velocity_x_mps,
        y_m=last.y_m + unseen_s * last.velocity_y_mps,
        unseen_s=unseen_s,
    )
