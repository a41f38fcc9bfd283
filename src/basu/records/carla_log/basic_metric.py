"""The base of metrics, as ScenarioRunner has it: a class with one method, which is called when it is made."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    import carla

    from basu.records.carla_log.metrics_log import MetricsLog


class BasicMetric(ABC):
    """A question to a recording; a file with one class of this kind is what ``basu metrics --metric`` takes."""

    def __init__(self, town_map: carla.Map, log: MetricsLog, criteria: Mapping[str, Any] | None = None) -> None:
        self._create_metric(town_map, log, criteria)

    @abstractmethod
    def _create_metric(self, town_map: carla.Map, log: MetricsLog, criteria: Mapping[str, Any] | None) -> None:
        """Ask the log, and print, draw or write what comes of it.

        Args:
            town_map: the map the run lay in.
            log: the recording.
            criteria: what the run was judged by, a dict a criterion; None where nobody judged.
        """
