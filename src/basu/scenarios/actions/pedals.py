"""Accelerate, brake and hold: changes of speed along a path or straight on."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.scenarios.actions.puppet import AtEnd, Limits, Puppet, minded

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.scenarios.paths import Path


class _ToSpeed(Puppet):
    """Change to a speed; done when it has it."""

    to_mps: float

    def wanted_mps(self) -> float:
        """The one to be reached."""
        return self.to_mps

    def over(self) -> str | None:
        """At the speed, once it is."""
        if abs(self.speed_mps - self.to_mps) > 1e-6:
            return None
        body = self.stage.body(self.actor)
        if abs(body.forward_mps - self.to_mps) > 0.3:
            return None
        return f"at {self.to_mps:.1f} m/s"


class Accelerate(_ToSpeed):
    """Let a vehicle accelerate to a speed, along a path or straight on; it goes on at that speed."""

    def __init__(
        self,
        actor: str,
        to_mps: float,
        at_mps2: float = 2.5,
        path: Path | None = None,
        *,
        considerate: bool = False,
        minds: Sequence[str] = (),
    ) -> None:
        super().__init__(
            f"{actor} accelerates to {to_mps:g} m/s",
            actor,
            path,
            limits=Limits(at_mps2, at_mps2),
            minds=minded(considerate=considerate, minds=minds),
        )
        self.to_mps = to_mps


class Brake(_ToSpeed):
    """Let a vehicle brake, by default to a stand, along a path or straight on."""

    def __init__(self, actor: str, to_mps: float = 0.0, at_mps2: float = 4.0, path: Path | None = None) -> None:
        goal = f" to {to_mps:g} m/s" if to_mps else ""
        at_end: AtEnd = "go on" if to_mps else "hold"
        super().__init__(
            f"{actor} brakes{goal} at {at_mps2:g} m/s²", actor, path, limits=Limits(at_mps2, at_mps2), at_end=at_end
        )
        self.to_mps = to_mps


class Hold(Puppet):
    """Hold a vehicle where it is, by its brakes, for some seconds."""

    def __init__(self, actor: str, seconds: float) -> None:
        super().__init__(f"{actor} stands for {seconds:.3g} s", actor, None, at_end="hold")
        self.seconds = seconds

    def begin(self) -> None:
        """Look at the clock."""
        super().begin()
        self.until_s = self.stage.time_s + self.seconds

    def wanted_mps(self) -> float:
        """None."""
        return 0.0

    def over(self) -> str | None:
        """When the time is over."""
        return f"stood for {self.seconds:.3g} s" if self.stage.time_s >= self.until_s - 1e-6 else None
