"""`Conduct`: ends the run as the agent's failure if its vehicle had another control than the one ``run_step`` returned.

The gate refuses all that an agent may not do. It lets an agent's client control its own vehicle, and it cannot know
which control the benchmark gave: so that is compared here, from the snapshot, without a call to the server.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.errors import AgentCrashedError

if TYPE_CHECKING:
    import carla

    from basu.managers.base_manager import Frame, Run

CONTROL_TOLERANCE = 1e-4  # a snapshot holds controls in single precision


class Conduct:
    """One run's check of the agent."""

    def __init__(self, name: str) -> None:
        """``name`` is the agent's."""
        self._name = name
        self._run: Run | None = None

    def begin(self, run: Run) -> None:
        """Check this run from now on."""
        self._run = run

    def before(self, frame: Frame) -> None:
        """Check that the vehicle had the benchmark's control in the step to this frame.

        Raises:
            AgentCrashedError: it had another one.
        """
        if self._run is None or self._run.changes.control is None:
            return
        given, had = self._run.changes.control, self._run.vehicle.get_control()
        if not is_same_control(given, had):
            raise AgentCrashedError(
                f"the vehicle had throttle {had.throttle:.2f}, steer {had.steer:.2f}, brake {had.brake:.2f} instead of "
                f"throttle {given.throttle:.2f}, steer {given.steer:.2f}, brake {given.brake:.2f} in the step to frame "
                f"{frame.server_frame}: {self._name} may drive it with the control that run_step() returns, and in no "
                "other way"
            )


def ticked(name: str, before: int, now: int) -> str:
    """The sentence about an agent that lets the world go on by itself."""
    return f"the simulator went from frame {before} to {now} by {name}: an agent never ticks the world"


def is_same_control(one: carla.VehicleControl, other: carla.VehicleControl) -> bool:
    """Whether two controls are equal but for the rounding of the wire. Gears are left out: the vehicle shifts them."""
    return bool(
        abs(one.throttle - other.throttle) < CONTROL_TOLERANCE
        and abs(one.steer - other.steer) < CONTROL_TOLERANCE
        and abs(one.brake - other.brake) < CONTROL_TOLERANCE
        and one.hand_brake == other.hand_brake
        and one.reverse == other.reverse
    )
