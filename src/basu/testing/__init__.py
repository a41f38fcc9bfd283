"""Rehearse a scenario on paper: no server, no physics, bodies that move exactly as told."""

from basu.testing.drivers import Driver, careful, steady, waiting_at
from basu.testing.paper_place import paper_place
from basu.testing.paper_stage import Command, PaperStage
from basu.testing.rehearse import Rehearsal, rehearse

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
