"""Adapters in both directions: foreign agents in ``basu run``, and BASU's agents in foreign hosts.

Foreign agents are written for the CARLA leaderboard or for ScenarioRunner; ``basu run`` drives them unmodified. Those
programs in turn load ``entry/basu_agent.py``; ``python -m basu_leaderboard`` prints its path.
"""
