"""CARLA's recorder files, read for questions that come later: columns, and the queries of ScenarioRunner's MetricsLog.

No server is needed. ``read_log`` gives the columns, ``MetricsLog`` the queries, ``town_map`` the map a run lay in.
"""

from basu_carla_log.log import Log, read_log

__all__ = ["Log", "read_log"]
