"""The person at the wheel, as the benchmark knows one: a plugin brings the page and recorded keys."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import carla


class Person(Protocol):
    """A person that may take over from the agent."""

    @property
    def drives_first(self) -> bool:
        """Whether the person drives when the drive begins."""

    def step(self, tick: int, dt_s: float, agents: carla.VehicleControl) -> carla.VehicleControl | None:
        """Return the person's control in a tick of ``dt_s`` seconds; None while the agent's control counts."""
