"""Agents written for the CARLA leaderboard or for ScenarioRunner, driven unmodified by ``basu run``.

The other direction, BASU's agents driven by those programs, is :mod:`basu.agents.export`.
"""
