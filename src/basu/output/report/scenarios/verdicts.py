"""How verdicts are written and counted: one sign, one word and one style each, told apart without colour."""

from __future__ import annotations

from typing import NamedTuple


class Look(NamedTuple):
    """How a verdict is shown."""

    sign: str  # one character, its own for each verdict that counts
    word: str
    style: str  # class in scenarios.css
    is_judged: bool  # whether it says something about the agent; the rest stays out of shares and counts


LOOKS = {
    "SUCCESS": Look("✓", "passed", "passed", is_judged=True),
    "FAILURE": Look("✗", "failed", "failed", is_judged=True),
    "AGENT_FAULT": Look("!", "agent fault", "broken", is_judged=True),
    "NOT_EXERCISED": Look("○", "not exercised", "absent", is_judged=False),
    "SIMULATOR_FAULT": Look("?", "simulator fault", "unjudged", is_judged=False),
    "SETUP_FAULT": Look("?", "set-up fault", "unjudged", is_judged=False),
    "BENCHMARK_FAULT": Look("?", "benchmark fault", "unjudged", is_judged=False),
    "INTERRUPTED": Look("?", "interrupted", "unjudged", is_judged=False),
}
