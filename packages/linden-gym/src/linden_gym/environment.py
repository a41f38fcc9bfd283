"""`WorldsVectorEnv`: many gymnasium environments on `linden.Worlds`, in one process, without a server or a client.

Actions, observations, rewards and ends are those of `basu.gym`; its docstring has shapes and units. The ``info`` has
arrays with one value for each environment: ``route_s_m``, ``infractions`` (how many are new), ``reward_parts``, and
at the end of an episode ``outcome``. There is no ``passed``: that needs the record of a drive.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import carla
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from basu.conditions import STEP_S
from basu.errors import UserError
from basu.gym import route_spec
from basu.gym_spaces import (
    FAILED,
    JUDGED_TICKS,
    TRUNCATED,
    Reward,
    RouteAhead,
    action_space,
    controls_from,
    observation_space,
)
from basu.gym_view import EgoRows, Others, Places
from basu.managers.observations import OVERHEAD_M, SMALLEST_M
from basu.metrics.ending import ARRIVED, GOES_ON, STATUS_OF
from basu.records.history import Vehicle
from basu.records.history.model import NEAR_M
from basu.routing import ControlKind, plan
from linden.errors import LindenError
from linden.physics.state import NO_BODY, PROP
from linden.worlds import Worlds
from linden_gym.drives import Drives
from linden_gym.lane_field import LaneField
from linden_gym.observing import observed
from linden_gym.starts import Starts, settled

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from basu.episode import EpisodeSpec
    from basu.routing import Route

Observations = dict[str, "NDArray[np.float32]"]
Infos = dict[str, Any]

EGO = 0
"""Slot of the vehicle under test in each world."""

_ENDINGS = range(GOES_ON, max(STATUS_OF) + 1)
_FAILED = np.array([STATUS_OF.get(ending) in FAILED for ending in _ENDINGS])
_TRUNCATED = np.array([STATUS_OF.get(ending) in TRUNCATED for ending in _ENDINGS])
_OUTCOME = np.array([STATUS_OF[ending].value if ending in STATUS_OF else None for ending in _ENDINGS], object)


class WorldsVectorEnv(VectorEnv[Observations, "NDArray[np.float32]", Any]):
    """``num_envs`` environments, each one vehicle on a route in a world of its own.

    Attributes:
        worlds: the worlds. Bodies that a user spawns there, in any slot but 0, are the ``others`` of the observations.
            They come back at each reset to where they were spawned.
        route: the route, with its points, stops and signs.
    """

    def __init__(
        self,
        num_envs: int,
        *,
        routes: str = "routes/linden_short.xml",
        route_id: str | None = None,
        vehicle: str | None = None,
        reward: Reward | None = None,
        with_scenarios: bool = True,
        start_m: float | tuple[float, float] = 0.0,
        device: str = "cpu",
        threads: int = 0,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        render_mode: str | None = None,
    ) -> None:
        """Make the worlds and plan the route. ``threads`` work on them, 0 being all processors.

        ``start_m`` is where along the route episodes begin, or between which two places they begin at random
        (`linden_gym.starts`).

        Raises:
            UserError: a setting cannot be used, or the route needs what these environments lack.
        """
        if render_mode is not None:
            raise UserError(f"there is no render mode '{render_mode}'; watch the trained driver by `basu run --watch`")
        try:
            self.autoreset_mode = AutoresetMode(autoreset_mode)
        except ValueError:
            modes = ", ".join(mode.value for mode in AutoresetMode)
            raise UserError(f"there is no autoreset_mode '{autoreset_mode}'; there are {modes}") from None
        spec = route_spec(routes=routes, route_id=route_id, vehicle=vehicle, with_scenarios=with_scenarios)
        try:
            self.worlds = Worlds(spec.town, num_envs, device=device, dt_s=STEP_S, threads=threads)
            carla_map = carla.Map(spec.town, self.worlds.map.text)
            self.route = plan(carla_map, spec.description(carla_map))
            _refuse_what_is_missing(spec, self.route)
            self._limits_kmh = settled(self.worlds, spec.config.vehicle, self.route.waypoints[:1])
            self._starts = Starts(self.route, self.worlds.map, spec.config.vehicle)
            self._start_m = self._starts.range_m(start_m)
        except LindenError as error:
            raise UserError(str(error)) from error
        self._first_limits_kmh = self._limits_kmh.copy()
        self.num_envs, self.render_mode, self.spec = num_envs, None, None
        self.metadata = {"render_modes": [], "render_fps": round(1.0 / STEP_S), "autoreset_mode": self.autoreset_mode}
        self.single_observation_space, self.single_action_space = observation_space(), action_space()
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._reward = Reward() if reward is None else reward
        box = self._box()
        self._ahead, self._threads = RouteAhead(self.route, box), threads
        lanes = LaneField(carla_map, self.worlds.map, self.route.points_m)
        self._drives = Drives(num_envs, self.route, self._ahead, lanes, box)
        self._all: NDArray[np.int64] = np.arange(num_envs, dtype=np.int64)
        self._over = np.ones(num_envs, np.bool_)  # environments with no episode
        self._reported = np.zeros(num_envs, np.int64)  # infractions

    def _box(self) -> Vehicle:
        """Return the box of the vehicle under test as records have it, of numbers of 32 bits."""
        body = self.worlds.state[0, EGO]
        (x_m, _, _), (half_m, side_m, _) = (_single(body[name]).tolist() for name in ("box_centre", "half_extent"))
        return Vehicle(type_id="", front_m=x_m + half_m, rear_m=half_m - x_m, width_m=2.0 * side_m)

    # -- gymnasium

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Observations, Infos]:
        """Begin an episode in every environment, or in those of ``options["reset_mask"]``, an array (N,) of bools.

        These episodes begin at ``options["start_m"]`` along the route, an array (N,) or a number, where it is given.
        It overrides the setting of that name. ``seed`` seeds the places that are drawn; nothing else is random.

        Raises:
            UserError: the seeds, the mask or the places cannot be used; no world has changed then.
        """
        if isinstance(seed, (int, np.integer)):
            super().reset(seed=int(seed))
        elif seed is not None and len(seed) != self.num_envs:
            raise UserError(f"{len(seed)} seeds for {self.num_envs} environments; give one to each, or a number")
        mask = np.ones(self.num_envs, np.bool_) if options is None else options.get("reset_mask")
        if mask is None:
            mask = np.ones(self.num_envs, np.bool_)
        if not isinstance(mask, np.ndarray) or mask.dtype != np.bool_ or mask.shape != (self.num_envs,):
            raise UserError(f"reset_mask needs an array ({self.num_envs},) of bools, not {mask!r}")
        places_m = None if options is None else options.get("start_m")
        from_m = None if places_m is None else self._starts.places_m(places_m, self.num_envs)
        if mask.any():
            self._begin(np.flatnonzero(mask), from_m)
        infos: Infos = {}
        self._tell(infos, mask, route_s_m=self._drives.table["s_m"].copy(), infractions=self._all * 0)
        return self._observed(self._all), infos

    def step(
        self, actions: NDArray[np.float32]
    ) -> tuple[Observations, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], Infos]:
        """Drive for 0.05 s in every environment.

        Raises:
            UserError: the actions have a wrong shape or type, or a value that is no number in -1..1; or an environment
                waits for a reset. No world has changed then.
        """
        controls = controls_from(actions, (self.num_envs,))
        begins = self._over.copy()
        if begins.any() and (
            self.autoreset_mode is not AutoresetMode.NEXT_STEP or (self._drives.table["tick"] < 0).any()
        ):
            waiting = np.flatnonzero(begins)
            raise UserError(
                f"environment {waiting[0]} has no episode; call reset(), or reset(options={{'reset_mask': ...}})"
            )
        rows = np.flatnonzero(~begins)
        driven_m, found = self._drives.driven_m, self._drives.infractions.copy()
        self.worlds.set_controls(controls.astype(np.float32))  # 32 bits, as a client sends them
        self.worlds.step()
        self.worlds.heed_limits(self._limits_kmh)
        self._look()
        self._drives.advance(rows, self._ego(rows), self._posted_mps(rows), self.worlds.contacts)
        if begins.any():
            self._begin(np.flatnonzero(begins))
        rewards, infos = self._judged(~begins, driven_m, found)
        ending = self._drives.table["ending"]
        truncated = _TRUNCATED[ending] | ~self.worlds.valid
        terminated = self._drives.ended & ~truncated
        self._over = terminated | truncated
        seen = self._observed(self._all)
        if self.autoreset_mode is AutoresetMode.SAME_STEP and self._over.any():
            infos = self._begin_again(seen, infos)
        return seen, rewards, terminated, truncated, infos

    def _judged(
        self, drove: NDArray[np.bool_], driven_m: NDArray[np.float64], found: NDArray[np.int64]
    ) -> tuple[NDArray[np.float64], Infos]:
        """Return rewards (N,) and infos of a step; ``driven_m`` and ``found`` are way and infractions before it."""
        drives = self._drives
        ended = drives.ended
        looked = drove & (ended | (drives.table["tick"] % JUDGED_TICKS == 0))
        known = np.where(ended, drives.infractions, found)  # a frame is recorded together with the control after it
        new = np.where(looked, np.maximum(0, known - self._reported), 0)
        self._reported[looked] = known[looked]
        ending = drives.table["ending"]
        parts = self._reward.parts(
            driven_m=drives.driven_m - driven_m,
            infractions=new,
            arrived=ending == ARRIVED,
            failed=_FAILED[ending],
            push_mps2=self._motion.push_mps2,
            lateral_m=drives.table["lateral_m"],
        )
        parts = {name: np.where(drove, np.broadcast_to(values, drove.shape), 0.0) for name, values in parts.items()}
        infos: Infos = {}
        every = np.ones_like(drove)
        self._tell(infos, every, route_s_m=drives.table["s_m"].copy(), infractions=new)
        told: Infos = {}
        self._tell(told, drove, **parts)
        self._tell(infos, drove, reward_parts=told)
        if ended.any():
            self._tell(infos, ended, outcome=_OUTCOME[ending])
        if not self.worlds.valid.all():
            self._tell(infos, ~self.worlds.valid, lost_in_space=~self.worlds.valid)
        return np.sum(list(parts.values()), axis=0), infos

    def _begin_again(self, seen: Observations, infos: Infos) -> Infos:
        """Begin the next episode of environments that have just ended, in ``seen`` as well; returns the infos."""
        ended, rows = self._over.copy(), np.flatnonzero(self._over)
        last = np.full(self.num_envs, None, object)
        for row in rows.tolist():
            last[row] = {name: values[row].copy() for name, values in seen.items()}
        final = {name: values for name, values in infos.items() if not name.startswith("_")}
        told: Infos = {}
        self._tell(told, ended, **final)
        self._begin(rows)
        for name, values in self._observed(rows).items():
            seen[name][rows] = values
        fresh: Infos = {}
        self._tell(fresh, np.ones_like(ended), route_s_m=self._drives.table["s_m"].copy())
        kept = {name: values for name, values in infos.items() if name not in {"outcome", "_outcome"}}
        self._tell(kept, ended, final_obs=last, final_info=told)
        return kept | fresh

    def _tell(self, infos: Infos, mask: NDArray[np.bool_], **values: Any) -> None:  # noqa: ANN401 - of any kind
        """Add values of the environments in ``mask``, as gymnasium's vectors have them."""
        for name, value in values.items():
            infos[name], infos[f"_{name}"] = value, mask.copy()

    def close_extras(self, **_kwargs: Any) -> None:  # noqa: ANN401 - gymnasium's signature
        """Do nothing: the worlds are memory of this process."""

    # -- the worlds

    def _begin(self, rows: NDArray[np.int64], from_m: NDArray[np.float64] | None = None) -> None:
        """Begin an episode in environments (K,), at places of ``from_m`` (N,) or drawn ones, with its first frame."""
        begins_m = self._start_m.draw(self.np_random, len(rows)) if from_m is None else from_m[rows]
        self.worlds.reset(rows)
        self._limits_kmh[rows] = self._first_limits_kmh[rows]
        away = np.flatnonzero(begins_m > 0.0)
        if len(away):
            begins_m[away], states, self._limits_kmh[rows[away]] = self._starts.at(begins_m[away])
            self.worlds.set_state(states, EGO, rows[away])
        self._look()
        self._drives.begin(rows, begins_m)
        self._drives.advance(rows, self._ego(rows), self._posted_mps(rows), self.worlds.contacts[:0])
        self._reported[rows], self._over[rows] = 0, False

    def _look(self) -> None:
        """Read the motion of the vehicles under test, rounded to 32 bits as a client gets it."""
        body = self.worlds.state[:, EGO]
        x_m, y_m, self._z_m = np.ascontiguousarray(_single(body["position"]).T)
        velocity_mps = np.ascontiguousarray(_single(body["velocity"]).T)
        push_mps2 = _single(body["acceleration"])
        self._motion = EgoRows(
            x_m=x_m,
            y_m=y_m,
            yaw_rad=_yaw_rad(body["rotation"][:, 1]),
            velocity_x_mps=velocity_mps[0],
            velocity_y_mps=velocity_mps[1],
            velocity_z_mps=velocity_mps[2],
            acceleration_x_mps2=push_mps2[:, 0],
            acceleration_y_mps2=push_mps2[:, 1],
            angular_velocity_z_radps=np.radians(_single(np.degrees(body["angular_velocity"][:, 2]))),
        )

    def _ego(self, rows: NDArray[np.int64]) -> EgoRows:
        """Return the motion of the vehicles under test in environments (K,)."""
        return self._motion if len(rows) == self.num_envs else EgoRows(*(column[rows] for column in self._motion))

    def _posted_mps(self, rows: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the limits (K,) that are posted to the vehicles."""
        return _single(self._limits_kmh[rows]) / 3.6

    def _observed(self, rows: NDArray[np.int64]) -> Observations:
        """Return the observations of environments (K,)."""
        drives, ego = self._drives.table[rows], self._ego(rows)
        others = self._others(rows, ego)
        places = Places(drives["s_m"], drives["lateral_m"], self._posted_mps(rows), self._drives.stopped[rows])
        return observed(self._ahead.columns, ego, places, others, self._threads)

    def _others(self, rows: NDArray[np.int64], ego: EgoRows) -> Others:
        """Return the bodies beside the vehicle, and which of them count.

        The place is that of the middle of the box, as in `basu.managers.observations`.
        """
        state = self.worlds.state
        if state.shape[1] == EGO + 1:
            return Others(np.zeros((len(rows), 0, 6)), np.zeros((len(rows), 0), np.bool_))
        body = state[rows, EGO + 1 :]
        position_m, velocity_mps = _single(body["position"]), _single(body["velocity"])
        yaw_rad = _yaw_rad(body["rotation"][..., 1])
        middle_m, half_m = _single(body["box_centre"]), _single(body["half_extent"])
        cos, sin = np.cos(yaw_rad), np.sin(yaw_rad)
        away_m = np.hypot(position_m[..., 0] - ego.x_m[:, None], position_m[..., 1] - ego.y_m[:, None])
        is_there = body["alive"] & (body["kind"] != NO_BODY) & (away_m <= NEAR_M)
        bottom_m = position_m[..., 2] + middle_m[..., 2] - np.maximum(half_m[..., 2], SMALLEST_M)
        is_there &= (body["kind"] != PROP) | (bottom_m < self._z_m[rows][:, None] + OVERHEAD_M)
        table = np.stack(
            [
                position_m[..., 0] + middle_m[..., 0] * cos - middle_m[..., 1] * sin,
                position_m[..., 1] + middle_m[..., 0] * sin + middle_m[..., 1] * cos,
                position_m[..., 2],
                yaw_rad,
                velocity_mps[..., 0],
                velocity_mps[..., 1],
            ],
            axis=-1,
        )
        return Others(table, is_there)


def _single(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return numbers rounded to 32 bits."""
    return values.astype(np.float32).astype(np.float64)


def _yaw_rad(yaw_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return yaws as a client gets them: degrees within (-180, 180] of 32 bits, in rad."""
    degrees = np.degrees(yaw_rad)
    return np.radians(_single(degrees - 360.0 * np.ceil((degrees - 180.0) / 360.0)))


def _refuse_what_is_missing(spec: EpisodeSpec, route: Route) -> None:
    """Check that the environments have all that a route needs.

    Raises:
        UserError: it has scenarios, weather or traffic lights.
    """
    lights = sum(control.kind is ControlKind.TRAFFIC_LIGHT for control in route.controls)
    if lights:
        raise UserError(f"route '{route.id}' has {lights} traffic lights, which are not judged here; {INSTEAD}")
    if spec.scenarios:
        raise UserError(f"route '{route.id}' has scenarios; leave them out by with_scenarios=False, or {INSTEAD}")
    if spec.weather_along:
        raise UserError(f"route '{route.id}' changes the weather on its way, which worlds do not have; {INSTEAD}")


INSTEAD = "use basu/Linden-v0, which drives through the official client"
