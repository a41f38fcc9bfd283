"""The aggressive profile of the behavioral agent."""

from __future__ import annotations

from basu.agents.behavioral import BehavioralAgent
from basu.agents.driving.manner import AGGRESSIVE


class AggressiveAgent(BehavioralAgent):
    """See `docs/agents.md`."""

    manner = AGGRESSIVE
