"""BASU's agents in the CARLA leaderboard and of ScenarioRunner, which load a file and call its class.

That file is ``entry/basu_agent.py``; ``python -m basu.agents.export`` prints its path. The other direction, their
agents in ``basu run``, is :mod:`basu.agents.leaderboard`.
"""
