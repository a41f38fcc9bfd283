"""The cautious profile of the behavioral agent."""

from __future__ import annotations

from basu.agents.builtin.behavioral import BehavioralAgent
from basu.agents.builtin.driving.manner import CAUTIOUS


class CautiousAgent(BehavioralAgent):
    """See `docs/agents.md`."""

    manner = CAUTIOUS
