"""A drive as the CARLA leaderboard would have scored it, in its versions 1.0, 2.0 and 2.1, from the same record."""

from basu.metrics.leaderboard.rules import Kind, LeaderboardEvent, Version
from basu.metrics.leaderboard.scores import LeaderboardScores, leaderboard_scores

__all__ = ["Kind", "LeaderboardEvent", "LeaderboardScores", "Version", "leaderboard_scores"]
