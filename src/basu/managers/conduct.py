"""Watches that the agent drives with the control that it returns, and with nothing else.

An agent in a process of its own has a client of its own, which may do all that CARLA's API offers: move the vehicle,
tick the world, change the weather. A change that the benchmark did not make ends the run as the agent's failure. Most
checks read the snapshots, which are there anyway. What needs a call to the server is read at random steps, some ten
ticks apart, and once more at the end.
"""

from __future__ import annotations

import math
import random
from collections import deque
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from basu.errors import AgentCrashedError, UserError
from basu.managers.world_changes import DRIFT_M, JUMP_M, LightsCheck, OthersCheck, agents_change, is_same_control
from basu.metrics.boxes import touching
from basu.routing.weather import WEATHER_FIELDS

if TYPE_CHECKING:
    import carla
    from numpy.typing import NDArray

    from basu.managers.base_manager import Ego, Frame, Run

DRIFT_TICKS = 20
"""Steps in which ways beyond what the velocities explain are summed up, for many small jumps."""
GAIN_MPS2 = 30.0
"""Gain or loss of speed that no vehicle's tyres give: three times the acceleration of gravity."""
NEAR_M = 3.0  # beyond both boxes: nothing that is farther away has just struck the vehicle
LOOK_TICKS = 10  # on average, from one reading of weather or physics to the next
HEARD_TICKS = 4  # after which a contact has been reported
CONTACT_TICKS = 3  # between a contact and a change of speed that it explains
INSIDE_M, INSIDE_TICKS = 0.3, 5
"""How deep, and in how many steps in a row, the vehicle may overlap another box without a reported contact."""
ABOVE_M = 2.0  # between the heights of two bodies, one of which passes over the other
PHYSICS = ("mass", "max_rpm", "moi", "drag_coefficient", "final_ratio", "use_gear_autobox")
WHEEL = ("max_steer_angle", "radius", "max_brake_torque", "max_handbrake_torque")


class _OwnBox(NamedTuple):
    """The box of the run's vehicle, read once: each reading by the client takes as long as twenty comparisons."""

    middle_m: float  # ahead of the vehicle's origin
    half_diagonal_m: float  # of the whole box
    half_length_m: float  # of the smaller box that must not overlap another
    half_width_m: float

    @classmethod
    def of(cls, vehicle: carla.Vehicle) -> _OwnBox:
        box = vehicle.bounding_box
        half_m = box.extent.x, box.extent.y
        return cls(box.location.x, math.hypot(*half_m), *(max(0.1, each - INSIDE_M) for each in half_m))


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
        self._box: _OwnBox | None = None
        self._inside: dict[int, int] = {}  # steps in a row, by the actor that the vehicle overlaps
        self._chance = random.SystemRandom()  # an agent cannot know it; an honest agent's run does not depend on it
        self._look_in_ticks, self._next_look = 1, 0

    def begin(self, run: Run) -> None:
        """Note what the agent must not change."""
        self._run, self._box = run, _OwnBox.of(run.vehicle)
        run.changes.checked = True
        self._state = {**_weather(run), **_physics(run), **_settings(run)}
        if run.own_simulator:
            if run.neighbours is not None:
                self._others = OthersCheck(run.neighbours, run.changes, run.step_s)
            self._lights = LightsCheck(run.world, run.route, run.changes, run.step_s)

    def set_up(self) -> None:
        """Check the world after the agent's setup.

        Raises:
            AgentCrashedError: the agent changed it.
        """
        if self._run is None:
            return
        changed = self._changed({**_weather(self._run), **_physics(self._run), **_settings(self._run)})
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
                now = (_weather, _physics)[self._next_look](self._run)
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
        self._look(self._last, {**_weather(self._run), **_physics(self._run), **_settings(self._run)})

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
        if fault is None and self._run is not None:
            fault = self._passed_through(frame, self._run)
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

    def _passed_through(self, frame: Frame, run: Run) -> str | None:
        """Half a sentence where the vehicle is inside another body, and the collision sensor reports no contact."""
        if run.neighbours is None:
            return None
        assert self._box is not None, "begin comes first"
        inside: dict[int, int] = {}
        for row in run.neighbours.near(frame):
            key = int(row[1])
            half_m = run.neighbours.sizes[key]
            if _is_inside(frame.ego, self._box, row, half_m):
                inside[key] = self._inside.get(key, 0) + 1
        self._inside = inside
        for key, ticks in inside.items():
            if ticks < INSIDE_TICKS + HEARD_TICKS:
                continue
            if not any(contact.other_id == key for contact in run.changes.contacts(0)):
                return f"drove through the actor {key} ({run.neighbours.met[key]}) without a contact"
        return None

    def _moved(self, frame: Frame, how: str) -> AgentCrashedError:
        return AgentCrashedError(
            f"the vehicle {how} in the step to frame {frame.server_frame}: {self._name} may drive it with the control "
            "that run_step() returns, and in no other way"
        )


def ticked(name: str, before: int, now: int) -> str:
    """The sentence about an agent that lets the world go on by itself."""
    return f"the simulator went from frame {before} to {now} by {name}: an agent never ticks the world"


def _weather(run: Run) -> dict[str, float]:
    """The weather, by names in a sentence; one call to the server."""
    weather = run.world.get_weather()
    return {f"the weather's {name}": float(getattr(weather, name)) for name in WEATHER_FIELDS}


def _physics(run: Run) -> dict[str, float]:
    """The vehicle's physics, likewise."""
    physics = run.vehicle.get_physics_control()
    values = {f"the vehicle's {name}": float(getattr(physics, name)) for name in PHYSICS}
    for index, wheel in enumerate(physics.wheels):
        values |= {f"the vehicle's wheel {index} {name}": float(getattr(wheel, name)) for name in WHEEL}
        values[f"the vehicle's wheel {index} tire_friction"] = float(wheel.tire_friction)
    values["the vehicle's torque"] = sum(float(point.y) for point in physics.torque_curve)
    values["the vehicle's gear ratios"] = sum(float(gear.ratio) for gear in physics.forward_gears)
    return values


def _settings(run: Run) -> dict[str, float]:
    """The world's settings, likewise."""
    settings = run.world.get_settings()
    return {
        "the world's synchronous mode": float(settings.synchronous_mode),
        "the world's time step": float(settings.fixed_delta_seconds or 0.0),
        "the world's rendering": float(not settings.no_rendering_mode),
    }


def _is_inside(ego: Ego, box: _OwnBox, row: tuple[float, ...], half_m: tuple[float, float]) -> bool:
    """Whether the vehicle's box, made smaller, overlaps that of a row of ``history.OTHER``."""
    reach_m = box.half_diagonal_m + math.hypot(*half_m)
    if math.hypot(row[2] - ego.x_m, row[3] - ego.y_m) > reach_m or abs(row[4] - ego.z_m) > ABOVE_M:
        return False
    cos, sin = math.cos(ego.yaw_rad), math.sin(ego.yaw_rad)
    x_m, y_m = ego.x_m + box.middle_m * cos, ego.y_m + box.middle_m * sin
    own = np.array([[x_m, y_m, ego.yaw_rad, box.half_length_m, box.half_width_m]])
    return bool(touching(own, np.array([[row[2], row[3], row[5], *half_m]]))[0])


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
