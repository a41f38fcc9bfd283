"""`Conduct`: ends the run as the agent's failure if the agent moved the ego, ticked the world or changed its state.

An agent in a process of its own has a client of its own, which may do all that CARLA's API offers: move the vehicle,
tick the world, change the weather. A change that the benchmark did not make ends the run as the agent's failure. Most
checks read the snapshots, which are there anyway. What needs a call to the server is read at random steps, some ten
ticks apart, and once more at the end.
"""

from __future__ import annotations

import math
import random
from collections import deque
from typing import TYPE_CHECKING, Any

import numpy as np

from basu.errors import AgentCrashedError, UserError
from basu.managers.base_manager import Frame, ego_in
from basu.managers.guarded_values import every_value, physics_values, weather_values
from basu.managers.interference import DRIFT_M, JUMP_M, LightsCheck, OthersCheck, agents_change, is_same_control
from basu.managers.overlap_check import HEARD_TICKS, OverlapCheck
from basu.routing.weather import WEATHER_FIELDS

if TYPE_CHECKING:
    import carla
    from numpy.typing import NDArray

    from basu.managers.base_manager import Ego, Run

DRIFT_TICKS = 20
"""Steps in which ways beyond what the velocities explain are summed up, for many small jumps."""
GAIN_MPS2 = 30.0
"""Gain or loss of speed that no vehicle's tyres give: three times the acceleration of gravity."""
NEAR_M = 3.0  # beyond both boxes: nothing that is farther away has just struck the vehicle
LOOK_TICKS = 10  # on average, from one reading of weather or physics to the next
CONTACT_TICKS = 3  # between a contact and a change of speed that it explains


class Conduct:
    """One run's checks of the agent.

    ``begin`` and ``set_up`` stand around the agent's setup, ``before`` and ``after`` around each step, and ``finish``
    after the last one.
    """

    def __init__(self, name: str) -> None:
        """``name`` is the agent's."""
        self._name = name
        self._run: Run | None = None
        self._last: Frame | None = None
        self._excess_m: deque[NDArray[np.float64]] = deque(maxlen=DRIFT_TICKS)
        self._state: dict[str, float] = {}
        self._others: OthersCheck | None = None
        self._lights: LightsCheck | None = None
        self._losses: deque[tuple[Frame, float]] = deque()  # of speed, which wait for their contact
        self._overlaps: OverlapCheck | None = None
        self._chance = random.SystemRandom()  # an agent cannot know it; an honest agent's run does not depend on it
        self._look_in_ticks, self._next_look = 1, 0

    def begin(self, run: Run) -> None:
        """Note what the agent must not change."""
        self._run = run
        if run.neighbours is not None:
            self._overlaps = OverlapCheck(run.vehicle, run.neighbours, run.changes)
        run.changes.checked = True
        self._state = every_value(run)
        if run.own_simulator:
            if run.neighbours is not None:
                self._others = OthersCheck(run.neighbours, run.changes, run.step_s)
            self._lights = LightsCheck(run.world, run.route, run.changes, run.step_s)
            self._begin_before_setup(run)

    def _begin_before_setup(self, run: Run) -> None:
        """Take the world before the agent's setup as the frame before the first one: setup is under the drive's rules.

        The vehicle stands then, and the step to the first frame is the only one until the agent's first answer.
        """
        snapshot = run.world.get_snapshot()
        seen = snapshot.find(run.vehicle.id)
        if seen is None:
            return
        self._last = Frame(-1, snapshot.frame, snapshot, ego_in(seen))
        for check in (self._others and self._others.fault(self._last), self._lights and self._lights.fault()):
            assert check is None, "there is nothing to compare with yet"

    def set_up(self) -> None:
        """Check the world after the agent's setup.

        Raises:
            AgentCrashedError: the agent changed it.
        """
        if self._run is None:
            return
        if self._last is not None:
            now = self._run.world.get_snapshot().frame
            if now != self._last.server_frame:
                raise AgentCrashedError(f"during setup() {ticked(self._name, self._last.server_frame, now)}")
        changed = self._changed(every_value(self._run))
        if changed:
            raise AgentCrashedError(
                f"setup() of {self._name} changed {', '.join(changed)} of the run; an agent may look at the world and "
                "drive, and nothing else"
            )

    def before(self, frame: Frame) -> None:
        """Check how the vehicle and the world got into this frame.

        Raises:
            AgentCrashedError: by something else than the control that the agent returned.
        """
        last, self._last = self._last, frame
        if self._run is None:
            return
        self._check_others(frame)
        self._check_control(frame, self._run)
        if last is None:
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
        loss_mps = float(np.linalg.norm(first_mps[:2]) - np.linalg.norm(second_mps[:2]))
        if loss_mps > GAIN_MPS2 * dt_s:
            self._losses.append((frame, loss_mps))
        self._check_losses(frame.tick - HEARD_TICKS, self._run)

    def after(self, frame: Frame) -> None:
        """Check that the world is still in this frame. At random steps, check values that need a call to the server.

        Raises:
            AgentCrashedError: it went on while the agent was to answer, or was changed.
            UserError: it was changed, in a simulator that other programs may use as well.
        """
        if self._run is None:
            return
        if self._run.own_simulator:
            now = self._run.world.get_snapshot().frame
            if now != frame.server_frame:
                raise AgentCrashedError(ticked(self._name, frame.server_frame, now))
        self._look_in_ticks -= 1
        if self._look_in_ticks <= 0:
            self._look_in_ticks = self._chance.randint(1, 2 * LOOK_TICKS)
            self._next_look = 1 - self._next_look
            try:
                now = (weather_values, physics_values)[self._next_look](self._run)
            except RuntimeError:  # the vehicle or the simulator is gone: the next step says which
                return
            self._look(frame, now)

    def finish(self) -> None:
        """Check the whole state once more after the last step.

        Raises:
            AgentCrashedError, UserError: as ``after``.
        """
        if self._run is None or self._last is None:
            return
        self._check_losses(self._last.tick, self._run)
        self._look(self._last, every_value(self._run))

    # -- single checks

    def _look(self, frame: Frame, now: dict[str, float]) -> None:
        """Compare what was read with what the benchmark has set."""
        changed = self._changed(now)
        if not changed:
            return
        what, run = ", ".join(changed), self._run
        if run is None or run.own_simulator or any(name.startswith("the vehicle's") for name in changed):
            raise agents_change(self._name, f"changed {what}", frame.server_frame)
        raise UserError(
            f"something changed {what} during the run, before frame {frame.server_frame}: the agent did, or another "
            "program at this simulator; a benchmark has to be the only program there, and an agent only drives"
        )

    def _changed(self, now: dict[str, float]) -> list[str]:
        """The names of the values that are not the benchmark's."""
        assert self._run is not None, "begin comes first"
        changes = self._run.changes
        expected = dict(self._state)
        if changes.weather is not None:
            expected |= {f"the weather's {name}": float(getattr(changes.weather, name)) for name in WEATHER_FIELDS}
        return [name for name, value in now.items() if not self._is_expected(name, value, expected[name])]

    def _is_expected(self, name: str, value: float, expected: float) -> bool:
        """Whether a value is the benchmark's, but for rounding; a wheel on a slippery place has its friction."""
        allowed = {expected}
        if name.endswith("tire_friction") and self._run is not None:
            allowed |= self._run.changes.frictions
        return any(math.isclose(value, each, rel_tol=1e-4, abs_tol=1e-3) for each in allowed)

    def _check_others(self, frame: Frame) -> None:
        """Check other actors and lights, and that the vehicle passes through none of them."""
        fault = self._others.fault(frame) if self._others is not None else None
        if fault is None and self._lights is not None:
            fault = self._lights.fault()
        if fault is None and self._overlaps is not None:
            fault = self._overlaps.fault(frame)
        if fault is not None:
            raise agents_change(self._name, fault, frame.server_frame)

    def _check_control(self, frame: Frame, run: Run) -> None:
        """Check that the vehicle had the benchmark's control in the step to this frame."""
        given = run.changes.control
        if given is None:
            return
        had = run.vehicle.get_control()  # of the latest snapshot: no call to the server
        if not is_same_control(given, had):
            raise self._moved(
                frame,
                f"had throttle {had.throttle:.2f}, steer {had.steer:.2f}, brake {had.brake:.2f} instead of throttle "
                f"{given.throttle:.2f}, steer {given.steer:.2f}, brake {given.brake:.2f}",
            )

    def _check_losses(self, until_tick: int, run: Run) -> None:
        """Check that each sudden loss of speed has a contact, once contacts until ``until_tick`` are known."""
        while self._losses and self._losses[0][0].tick <= until_tick:
            frame, loss_mps = self._losses.popleft()
            contacts = run.changes.contacts(max(0, frame.tick - CONTACT_TICKS))
            if not any(abs(contact.tick - frame.tick) <= CONTACT_TICKS for contact in contacts):
                raise self._moved(frame, f"lost {loss_mps:.1f} m/s in one step and touched nothing")

    def _moved(self, frame: Frame, how: str) -> AgentCrashedError:
        return AgentCrashedError(
            f"the vehicle {how} in the step to frame {frame.server_frame}: {self._name} may drive it with the control "
            "that run_step() returns, and in no other way"
        )


def ticked(name: str, before: int, now: int) -> str:
    """The sentence about an agent that lets the world go on by itself."""
    return f"the simulator went from frame {before} to {now} by {name}: an agent never ticks the world"


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
