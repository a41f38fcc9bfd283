"""Rehearse a scenario on paper: no server, no physics, bodies that move exactly as told."""

from basu.scenarios.rehearsal.drivers import Driver, careful, steady, waiting_at
from basu.scenarios.rehearsal.paper_place import paper_place
from basu.scenarios.rehearsal.paper_stage import Command, PaperStage
from basu.scenarios.rehearsal.rehearse import Rehearsal, rehearse

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
