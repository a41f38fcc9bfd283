"""What ``basu run`` was asked for."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

STEP_S = 0.05  # simulated time from tick to tick: 20 Hz
HUD_VIEWS = ("camera", "map")


class Traffic(NamedTuple):
    """How many others are to be on the road; vehicles by number or, where a density is given, by that."""

    vehicles: int = 0
    walkers: int = 0
    density_per_km: float | None = None  # vehicles on a km of driving lane near the route

    @property
    def nobody(self) -> bool:
        """Whether the vehicle under test is to be alone."""
        return self == NOBODY


NOBODY = Traffic()


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """The options of one ``basu run``, parsed."""

    agent: str = "basic"
    agent_config: str | None = None  # for agents of the leaderboard and of ScenarioRunner
    host: str | None = None  # None: start a simulator of our own
    port: int = 2000
    timeout_s: float = 20.0
    routes: str | None = None  # None: as the agent's config says
    route_id: str | None = None  # None: every route of the file
    routes_subset: str | None = None  # `0-3,7`, likewise
    repetitions: int = 1
    seed: int = 0  # of the first repetition; each further one has the next
    weather: str | None = None  # None: as the route file or else the agent's config says
    vehicle: str | None = None  # None: as the agent's config says
    traffic: Traffic = NOBODY
    with_scenarios: bool = True  # meet those that the route file has on the way
    scenario_files: tuple[Path, ...] = ()  # Python files with scenarios of one's own
    record: bool = False
    viewer: bool = False  # stream the run to Rerun's viewer, and keep it
    output: Path = Path("runs")
    series: str | None = None  # the folder in `output` that holds all runs and their totals
    resume: bool = False
    step_limit_s: float = 10.0  # wall time that one step of the agent may take
    in_process: bool = False  # drive the agent in the benchmark's own process, for debuggers
    agent_memory_gb: float | None = None  # what the agent's process may use; None: as much as there is
    debug: bool = False
    hud: str | None = None  # one of HUD_VIEWS: with a window
    hud_size: tuple[int, int] = (960, 540)  # of the window, in pixels
    hud_camera: tuple[int, int] = (480, 270)  # of its camera, likewise
    hud_screenshot: Path | None = None
    keys: str | None = None  # a session of keys to play
    record_keys: Path | None = None
