"""The conditions of a drive as domain types with defaults: step, simulator, traffic, SUMO, and the agent's track.

Episodes, managers and the gymnasium take these. The command line fills them from its options.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NamedTuple, get_args

STEP_S = 0.05  # simulated time from tick to tick: 20 Hz
ROLE = "hero"  # of the vehicle under test, as the leaderboard and CARLA's replayer call it

Track = Literal["world", "objects", "sensors"]
"""What an agent learns of other actors; scores of different tracks are never compared."""
WORLD, OBJECTS, SENSORS = "world", "objects", "sensors"
TRACKS: tuple[str, ...] = get_args(Track)

LeaderboardTrack = Literal["SENSORS", "MAP", "SENSORS_QUALIFIER", "MAP_QUALIFIER"]
"""A track of the CARLA leaderboard 2.x: which sensors an agent may have, how many and where."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatorSpec:
    """The simulator of a drive: the one at ``host``, or one of our own."""

    host: str | None = None
    port: int = 2000
    timeout_s: float = 20.0  # of wall time to wait for an answer
    maps: tuple[Path, ...] = ()  # folders of .xodr files that our own offers as well
    upload_map: Path | None = None  # sent to the one at `host`
    recordings: Path | None = None  # the folder below which our own may write CARLA's logs
    is_open: bool = False  # without the gate between agents and simulator


class Traffic(NamedTuple):
    """How many others are to be on the road; vehicles by number or, where a density is given, by that."""

    vehicles: int = 0
    walkers: int = 0
    density_per_km: float | None = None  # vehicles on a km of driving lane near the route

    @property
    def is_empty(self) -> bool:
        """Whether the vehicle under test is to be alone."""
        return self == NO_TRAFFIC


NO_TRAFFIC = Traffic()


class Sumo(NamedTuple):
    """The task of SUMO in a drive."""

    file: Path | None = None  # a finished .sumocfg; None: the agent's folder, or one made of the town's map
    is_random: bool = False  # random trips instead of the demand
    vehicles: int = 0  # that random trips keep on the road
    radius_m: float | None = None  # around the vehicle under test, within which vehicles are shown; None: all
    lights: str = "carla"  # which side has the lights
    port: int | None = None  # of a SUMO that runs
    folder: str | None = None  # that the agent's config() names
    beside: Path | None = None  # the agent's file, for relative names
    hour: float | None = None  # of the day, for a demand that is made; None: the hour that the route stands for
    scale: float | None = None  # of the traffic; None: as it is
    has_output: bool = False  # SUMO's own outputs in the run's folder
    has_riders: bool = True  # passengers of the shuttle; False where an operator brings its own
