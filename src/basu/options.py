"""What ``basu run`` was asked for."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

STEP_S = 0.05  # simulated time from tick to tick: 20 Hz


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """The options of one ``basu run``, parsed."""

    agent: str = "basic"
    host: str | None = None  # None: start a simulator of our own
    port: int = 2000
    timeout_s: float = 20.0
    routes: str | None = None  # None: as the agent's config says
    route_id: str | None = None  # None: every route of the file
    repetitions: int = 1
    seed: int = 0
    output: Path = Path("runs")
    step_limit_s: float = 10.0  # wall time that one step of the agent may take
    debug: bool = False
