"""The leaderboard's rules on sensors by track: types, numbers, distance from the vehicle's origin, and settings.

Source: ``validate_sensor_configuration`` and ``_preprocess_sensor_spec`` in ``leaderboard/autoagents/agent_wrapper.py``
of carla-simulator/leaderboard, branches leaderboard-2.0 and leaderboard-2.1, which agree. The rules are checked in the
benchmark's process, before the simulator gets the sensors. So an agent cannot change them from its own process.
"""

from __future__ import annotations

import enum
import math
from collections import Counter
from typing import TYPE_CHECKING

from basu.errors import UserError
from basu_leaderboard.sensor_sets import CAMERA_FIELDS, FIXED, OPENDRIVE_MAP, PSEUDO, SPEEDOMETER, TAKEN

if TYPE_CHECKING:
    from basu.agents.sensor_file import SensorSpec
    from basu.conditions import LeaderboardTrack

FARTHEST_M = 3.0  # MAX_ALLOWED_RADIUS_SENSOR
LIMITS = {
    "sensor.camera.rgb": 8,
    "sensor.lidar.ray_cast": 2,
    "sensor.other.radar": 4,
    "sensor.other.gnss": 1,
    "sensor.other.imu": 1,
    OPENDRIVE_MAP: 1,
    SPEEDOMETER: 1,
}
"""SENSORS_LIMITS: how many of each type; no other type is allowed."""
QUALIFIER_LIMITS = {**LIMITS, "sensor.camera.rgb": 4, "sensor.lidar.ray_cast": 1, "sensor.other.radar": 2}
OWN_FIELDS = {
    "sensor.camera.rgb": frozenset({"image_size_x", "image_size_y", *CAMERA_FIELDS[2:]}),
    **{kind: frozenset(fields) for kind, fields in TAKEN.items()},
}
"""The attributes that an agent chooses itself; the leaderboard sets all others."""


class TrackRules:
    """The rules of one track for the sensors of one run."""

    def __init__(self, track: LeaderboardTrack) -> None:
        """Take the track of ``--leaderboard-track``."""
        self._track = track
        self._types: list[str] = []
        self._refused: str | None = None

    def admit(self, specs: tuple[SensorSpec, ...], source: str) -> tuple[SensorSpec, ...]:
        """Return the sensors that the simulator has, without the speedometer and the map, which it has not.

        Raises:
            UserError: the set breaks a rule of the track; the sentence names it.
        """
        self._refused = next(filter(None, (self._broken_by(spec) for spec in specs)), None) or self._too_many(specs)
        if self._refused is not None:
            raise UserError(f"{source}: {self._refused}")
        self._types = [spec.type_id for spec in specs]
        return tuple(spec for spec in specs if spec.type_id not in PSEUDO)

    def document(self) -> dict[str, object]:
        """Return the track, the types of the admitted sensors, and the sentence of a refusal."""
        return {"track": self._track, "sensors": self._types, "refused": self._refused}

    def _broken_by(self, spec: SensorSpec) -> str | None:
        """Return the rule that one sensor breaks, as a sentence."""
        track, named = f"the leaderboard's track {self._track}", f"'{spec.id}' ({spec.type_id})"
        if spec.type_id not in LIMITS:
            return f"{track} has no sensor of the type of {named}; it has {', '.join(LIMITS)}"
        if spec.type_id == OPENDRIVE_MAP and not self._track.startswith("MAP"):
            return f"{track} gives no map, and {named} is one; leave it out, or take part in the track MAP"
        away_m = math.hypot(spec.x_m, spec.y_m, spec.z_m)
        if away_m > FARTHEST_M:
            return (
                f"{track} takes sensors within {FARTHEST_M:g} m of the vehicle's origin, and {named} is "
                f"{away_m:.2f} m away; mount it nearer"
            )
        fixed = FIXED.get(spec.type_id, {})
        given = dict(spec.attributes)
        own = OWN_FIELDS.get(spec.type_id, frozenset())
        for name in sorted({*fixed, *given} - own):
            if name not in fixed:
                return f"{track} lets no agent set '{name}', and {named} does; leave it out"
            if name not in given or float(given[name]) != float(fixed[name]):
                return (
                    f"{track} sets {name} = {fixed[name]:g} for every {spec.type_id}, and {named} has "
                    f"{given.get(name, 'the default of CARLA')}; give it this value"
                )
        return None

    def _too_many(self, specs: tuple[SensorSpec, ...]) -> str | None:
        """Return the sentence for the first type of which there are too many."""
        limits = QUALIFIER_LIMITS if self._track.endswith("QUALIFIER") else LIMITS
        for kind, count in Counter(spec.type_id for spec in specs).items():
            if count > limits[kind]:
                return (
                    f"the leaderboard's track {self._track} takes at most {limits[kind]} {kind}, and these are "
                    f"{count}; leave {count - limits[kind]} out"
                )
        return None


def check_declared(declared: object, wanted: str, agent: str) -> None:
    """Check that an agent takes part in the track that it is run in.

    Args:
        declared: its ``track``: a member of the leaderboard's ``Track``, of BASU's or of its own.
        wanted: the track of ``--leaderboard-track``.
        agent: the name of its class.

    Raises:
        UserError: it says another, or none.
    """
    said = declared.value if isinstance(declared, enum.Enum) else declared
    if said != wanted:
        raise UserError(
            f"{agent} has track = {said!r}, and --leaderboard-track is {wanted}; set self.track in its setup, or give "
            "the option its track"
        )
