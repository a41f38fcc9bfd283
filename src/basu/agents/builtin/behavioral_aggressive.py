"""The aggressive profile of the behavioral agent."""

from __future__ import annotations

from basu.agents.builtin.behavioral import BehavioralAgent
from basu.agents.builtin.driving.manner import AGGRESSIVE


class AggressiveAgent(BehavioralAgent):
    """See `docs/agents.md`."""

    manner = AGGRESSIVE
