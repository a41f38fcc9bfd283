"""One drive of vehicles under test along a route: the loop under runs, cases, gymnasium environments and notebooks."""

from basu.episode.episode import Episode
from basu.episode.spec import EpisodeSpec, case_spec
from basu.episode.vehicle_under_test import DriverResponse, DriverSetup, Observation, VehicleUnderTest, seed_of
from basu.episode.world import Town, Towns

__all__ = [
    "DriverResponse",
    "DriverSetup",
    "Episode",
    "EpisodeSpec",
    "Observation",
    "Town",
    "Towns",
    "VehicleUnderTest",
    "case_spec",
    "seed_of",
]
