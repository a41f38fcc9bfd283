"""Rehearse a scenario on paper: no server, no physics, bodies that move exactly as told."""

from basu.testing.offline_stage import Command, PaperStage, paper_place
from basu.testing.rehearsal import Driver, Rehearsal, careful, rehearse, steady, waiting_at

__all__ = [
    "Command",
    "Driver",
    "PaperStage",
    "Rehearsal",
    "careful",
    "paper_place",
    "rehearse",
    "steady",
    "waiting_at",
]
