"""Write docs/reference/rules.md: the rules of judgement, with figures from the code: `make_rules_page.py [--check]`.

The text stands in ``rules_page.md.j2``. Its figures are constants by the names of their modules.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

from generated_page import write_or_check
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from basu import conditions, intervals, thresholds
from basu.agents import calls
from basu.campaigns.settings import Campaign
from basu.managers import scenario_manager
from basu.metrics import (
    collisions,
    delays,
    fault,
    lanes,
    path_following,
    red_lights,
    right_of_way,
    speeding,
    stop_signs,
    validity,
)
from basu.metrics.passengers import causes, comfort_score, filters, harsh_stops, near_misses, service, verdict
from basu.metrics.result import COMPARABLE
from basu.metrics.scoring import Scoring
from basu.options import agent
from basu.outcome import Fault, Status
from basu.records.history import model
from basu.scenarios import continuations, exercise, policy, scenario
from basu.scenarios.triggers import along_route
from basu.scenarios.verdict import BROKEN, Verdict

HERE = Path(__file__).parent
PAGE = HERE.parent / "docs" / "reference" / "rules.md"
MODULES = (
    agent,
    along_route,
    calls,
    causes,
    collisions,
    comfort_score,
    continuations,
    delays,
    exercise,
    fault,
    filters,
    harsh_stops,
    intervals,
    lanes,
    model,
    near_misses,
    path_following,
    policy,
    red_lights,
    right_of_way,
    scenario,
    scenario_manager,
    service,
    speeding,
    stop_signs,
    thresholds,
    validity,
    verdict,
    sys.modules["basu.metrics.passengers.felt"],  # the package has a function of this name
)
PARTIES = {
    Fault.NONE: "none",
    Fault.AGENT: "agent",
    Fault.SETUP: "set-up, or the machine",
    Fault.SIMULATOR: "simulator",
    Fault.BENCHMARK: "BASU itself, by a defect",
    Fault.USER: "user",
}


def figure(value: float) -> str:
    """Return a figure as the page has it, without the last digits of its arithmetic."""
    return f"{value:.6g}"


def degrees(angle_rad: float) -> str:
    """Return an angle as the page has it."""
    return f"{figure(abs(math.degrees(angle_rad)))}°"


def code(names: list[str], last: str = ", ") -> str:
    """Return names as code, the last one behind ``last``."""
    marked = [f"`{name}`" for name in names]
    return last.join([", ".join(marked[:-1]), marked[-1]] if len(marked) > 1 else marked)


def page() -> str:
    """Return the page of rules as Markdown."""
    environment = Environment(
        loader=FileSystemLoader(HERE),
        undefined=StrictUndefined,
        keep_trailing_newline=True,
        autoescape=False,
    )
    environment.filters |= {"n": figure, "deg": degrees}
    return environment.get_template("rules_page.md.j2").render(
        {module.__name__.rpartition(".")[2]: module for module in MODULES},
        scoring=Scoring(),
        confidence=Campaign.model_fields["confidence"].default,
        tracks=code(list(conditions.TRACKS), " or "),
        counted=", ".join(one.value for one in Verdict if one.counts),
        agent_ends=code([status.value for status in BROKEN], " or "),
        comparable=code([status.value for status in Status if status in COMPARABLE], " or "),
        parties=[
            (party, by.value, code([status.value for status in Status if status.fault is by]))
            for by, party in PARTIES.items()
        ],
    )


if __name__ == "__main__":
    sys.exit(write_or_check(__file__, __doc__, lambda: {PAGE: page()}))
