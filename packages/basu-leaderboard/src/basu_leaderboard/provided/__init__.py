"""Substitutes for modules of ``leaderboard``, ``srunner`` and ``agents`` that agents import if these are missing.

Our own code with their names and meanings, as small as agents need it: base classes, look-ups, the clock, the options
of a plan. :mod:`basu_leaderboard.replacement_modules` says under which names. Whatever drives
(``agents.navigation.basic_agent``), plans or builds scenarios is not here:
it comes from CARLA's and ScenarioRunner's own folders.
"""
