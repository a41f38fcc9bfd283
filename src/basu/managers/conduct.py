"""Watches that the agent drives with the control that it returns, and with nothing else.

An agent in a process of its own has a client of its own, which may do all that CARLA's API offers: move the vehicle,
tick the world, change the weather. What can be seen of that in the snapshots, which are there anyway, ends the run as
the agent's failure.
"""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING, Any

import numpy as np

from basu.errors import AgentCrashedError

if TYPE_CHECKING:
    import carla
    from numpy.typing import NDArray

    from basu.managers.base_manager import Ego, Frame, Run

JUMP_M = 1.0
"""Way in one step beyond what the velocity explains. In Linden's drives, crashes included, it is below 0.0001 m."""
DRIFT_M, DRIFT_TICKS = 2.0, 20
"""Way in so many steps beyond what the velocities explain, for many small jumps; there it is below 0.06 m."""
GAIN_MPS2 = 30.0
"""Gain of speed that no vehicle's tyres give: three times the acceleration of gravity."""
NEAR_M = 3.0  # beyond both boxes: nothing that is farther away has just struck the vehicle
WEATHER = ("cloudiness", "precipitation", "precipitation_deposits", "fog_density", "wetness", "sun_altitude_angle")
PHYSICS = ("mass", "max_rpm", "moi", "drag_coefficient", "final_ratio")


class Conduct:
    """One run's. ``begin`` and ``set_up`` stand around the agent's setup, ``before`` and ``after`` around each step."""

    def __init__(self, name: str) -> None:
        """``name`` is the agent's."""
        self._name = name
        self._run: Run | None = None
        self._last: Frame | None = None
        self._excess_m: deque[NDArray[np.float64]] = deque(maxlen=DRIFT_TICKS)
        self._state: dict[str, float] = {}

    def begin(self, run: Run) -> None:
        """Note what the agent's setup must not change."""
        self._run = run
        self._state = _state(run)

    def set_up(self) -> None:
        """Check the world after the agent's setup.

        Raises:
            AgentCrashedError: the agent changed it.
        """
        if self._run is None:
            return
        now = _state(self._run)
        changed = [name for name, value in self._state.items() if not math.isclose(now[name], value, abs_tol=1e-6)]
        if changed:
            raise AgentCrashedError(
                f"setup() of {self._name} changed {', '.join(changed)} of the run; an agent may look at the world and "
                "drive, and nothing else"
            )

    def before(self, frame: Frame) -> None:
        """Check how the vehicle got into this frame.

        Raises:
            AgentCrashedError: not by driving.
        """
        last, self._last = self._last, frame
        if last is None or self._run is None:
            return
        dt_s = self._run.step_s
        way_m = _place_m(frame.ego) - _place_m(last.ego)
        first_mps, second_mps = _velocity_mps(last.ego), _velocity_mps(frame.ego)
        self._excess_m.append(way_m - 0.5 * dt_s * (first_mps + second_mps))
        speeds_mps = float(np.linalg.norm(first_mps)), float(np.linalg.norm(second_mps))
        jump_m = float(np.linalg.norm(way_m)) - dt_s * max(speeds_mps)
        drift_m = float(np.linalg.norm(sum(self._excess_m)))
        if jump_m > JUMP_M or drift_m > DRIFT_M:
            raise self._moved(frame, f"moved {max(jump_m, drift_m):.1f} m farther than its speed explains")
        gain_mps = speeds_mps[1] - speeds_mps[0]
        if gain_mps > GAIN_MPS2 * dt_s and not _is_something_near(frame, self._run):
            raise self._moved(frame, f"gained {gain_mps:.1f} m/s in one step with nothing near that struck it")

    def after(self, frame: Frame) -> None:
        """Check that the world still is in this frame.

        Raises:
            AgentCrashedError: it went on while the agent was to answer.
        """
        if self._run is not None and self._run.own_simulator:
            now = self._run.world.get_snapshot().frame
            if now != frame.server_frame:
                raise AgentCrashedError(ticked(self._name, frame.server_frame, now))

    def _moved(self, frame: Frame, how: str) -> AgentCrashedError:
        return AgentCrashedError(
            f"the vehicle {how} in the step to frame {frame.server_frame}: {self._name} may drive it with the control "
            "that run_step() returns, and in no other way"
        )


def ticked(name: str, before: int, now: int) -> str:
    """The sentence about an agent that lets the world go on by itself."""
    return f"the simulator went from frame {before} to {now} by {name}: an agent never ticks the world"


def _state(run: Run) -> dict[str, float]:
    """What an agent must not change, by its name in a sentence."""
    weather, physics, settings = run.world.get_weather(), run.vehicle.get_physics_control(), run.world.get_settings()
    values = {f"the weather's {name}": float(getattr(weather, name)) for name in WEATHER}
    values |= {f"the vehicle's {name}": float(getattr(physics, name)) for name in PHYSICS}
    values["the world's synchronous mode"] = float(settings.synchronous_mode)
    values["the world's time step"] = float(settings.fixed_delta_seconds or 0.0)
    return values


def _is_something_near(frame: Frame, run: Run) -> bool:
    """Whether another body is near enough to have struck the vehicle."""
    own_m = _half_length_m(run.vehicle)
    ids = [actor.id for actor in frame.snapshot if actor.id != run.vehicle.id]
    for actor in run.world.get_actors(ids):
        if not actor.type_id.startswith(("vehicle.", "walker.", "static.prop.")):
            continue
        seen: Any = frame.snapshot.find(actor.id)
        at = seen.get_transform().location
        if math.dist((at.x, at.y), (frame.ego.x_m, frame.ego.y_m)) < own_m + _half_length_m(actor) + NEAR_M:
            return True
    return False


def _half_length_m(actor: carla.Actor) -> float:
    """Half of the diagonal of an actor's box in the plane."""
    extent = actor.bounding_box.extent
    return math.hypot(extent.x, extent.y)


def _place_m(ego: Ego) -> NDArray[np.float64]:
    return np.array([ego.x_m, ego.y_m, ego.z_m])


def _velocity_mps(ego: Ego) -> NDArray[np.float64]:
    return np.array([ego.velocity_x_mps, ego.velocity_y_mps, ego.velocity_z_mps])
