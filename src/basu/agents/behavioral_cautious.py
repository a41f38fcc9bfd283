"""The cautious profile of the behavioral agent."""

from __future__ import annotations

from basu.agents.behavioral import BehavioralAgent
from basu.agents.driving.manner import CAUTIOUS


class CautiousAgent(BehavioralAgent):
    """See `docs/agents.md`."""

    manner = CAUTIOUS
