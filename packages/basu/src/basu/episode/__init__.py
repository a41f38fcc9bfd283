"""One drive of one vehicle along one route: the loop under runs, cases, the gymnasium environment and notebooks."""

from basu.episode.episode import Episode, Observation, Step
from basu.episode.spec import EpisodeSpec, case_spec
from basu.episode.world import Town, Towns

__all__ = ["Episode", "EpisodeSpec", "Observation", "Step", "Town", "Towns", "case_spec"]
