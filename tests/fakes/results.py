"""Results of drives that never took place, as they stand in result.json."""

import json
from typing import Any

from basu.metrics.result import judge
from basu.outcome import Outcome, Status
from basu.records.history import LaneInvasion
from fakes.drives import at, driven, hit

META = {
    "simulated_s": 20.0,
    "wall_s": 1.5,
    "ticks": 400,
    "step_s": 0.05,
    "first_server_frame": 21,
    "started": "2026-11-21T12:00:00+00:00",
    "seed": 0,
    "agent": {"name": "basic", "class": "BasicAgent", "file": "basic"},
    "vehicle": "vehicle.easymile.ez10",
    "weather": "ClearNoon",
    "traffic": {"vehicles": 0, "walkers": 0, "density_per_km": None},
    "route": "0",
    "town": "Linden",
    "versions": {"basu": "0.1.0"},
}


def a_result(status: Status = Status.COMPLETED, *, safe: bool = False) -> dict[str, Any]:
    """As it is after a round trip through a file: a collision, and a while above the limit, or neither if ``safe``."""
    history = driven(
        at(10.0, 10.0) + at(10.0 if safe else 13.0, 5.0),
        collisions=[] if safe else [hit(50)],
        lane_invasions=[LaneInvasion(tick=3, markings=("Solid/White",))],
    )
    document = judge(Outcome(status, "so it ended"), history, meta=META).document()
    plain: dict[str, Any] = json.loads(json.dumps(document))
    return plain
