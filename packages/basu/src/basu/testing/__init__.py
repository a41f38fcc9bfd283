"""Play a scenario offline: no server, no physics, bodies that move exactly as commanded."""

from basu.testing.offline_stage import OfflineStage, StageCommand, offline_place
from basu.testing.rehearsal import Driver, Rehearsal, careful, rehearse, steady, waiting_at

__all__ = [
    "Driver",
    "OfflineStage",
    "Rehearsal",
    "StageCommand",
    "careful",
    "offline_place",
    "rehearse",
    "steady",
    "waiting_at",
]
