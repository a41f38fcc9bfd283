"""The managers of the thesis: each holds one concern of a run."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from basu.managers.agents_manager import AgentsManager
    from basu.managers.base_manager import DriverState
    from basu.managers.metrics_manager import MetricsManager
    from basu.managers.routes_manager import RoutesManager
    from basu.managers.sensors_manager import SensorsManager


class Live(NamedTuple):
    """The managers of a run, for observers."""

    agents: DriverState | AgentsManager
    sensors: SensorsManager
    routes: RoutesManager
    metrics: MetricsManager
