"""`Errands`: vehicles and walkers that a page has sent somewhere, driven in each frame until they arrive.

A vehicle follows the way of `linden_window.ways` and keeps to the posted limit. It waits behind actors on its way. It
also waits while CARLA's ``get_traffic_light_state`` is red or yellow, at lights, stop signs and yield signs. It knows
no other right of way. A walker walks straight to the place.
"""

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from linden.blueprints.library import BlueprintKind
from linden.errors import Refusal
from linden.protocol.values.control import VehicleControl, WalkerControl
from linden.protocol.values.enums import TrafficLightState
from linden.protocol.values.snapshot import VEHICLE_ROW
from linden.protocol.values.space import Vector3D
from linden.simulation.actor_table import NO_BODY

if TYPE_CHECKING:
    from collections.abc import Callable

    from linden.simulation.episode import Episode
    from linden.world import World

F64 = NDArray[np.float64]

MOST_POINTS = 20_000
"""Points of one way: 30 km."""
_ARRIVED_M = 2.0
_LOOKS_M, _LOOKS_S = 3.0, 0.5
"""A vehicle steers towards the point of its way so far ahead."""
_WHEELBASE = 0.6
"""Of a vehicle's length."""
_SEES_M = 40.0
_BESIDE_M = 0.6
"""Room that a vehicle leaves at its sides."""
_BEHIND_M = 3.0
"""Room that it leaves ahead when it waits."""
_SLOWS_MPS2 = 2.0
_GIVES_GAS, _BRAKES = 0.2, 0.25
"""Pedal for each m/s of difference between the wanted and the present speed."""
_HALTS_MPS = 0.3
_CREEPS_MPS = 1.0
_WALKS_MPS = 1.4
_STUCK_S = 20.0
"""A walker that has come no nearer for so long stands before something, and gives up."""


@dataclass
class _Errand:
    """One actor on its way; ``points`` (N, 3) are x, y in m and speed in m/s."""

    points: F64
    full_steer_rad: float = 1.0
    at: int = 0
    nearest_m: float = math.inf
    waited_s: float = 0.0
    gone: F64 = field(init=False)

    def __post_init__(self) -> None:
        self.gone = np.append(0.0, np.cumsum(np.hypot(*np.diff(self.points[:, :2], axis=0).T)))


class Errands:
    """The actors of one world that are on their way."""

    def __init__(self, world: "World", say: "Callable[[str], None]") -> None:
        """``say`` gets a sentence when an actor has arrived or cannot."""
        self._world, self._say = world, say
        self._episode: object = None
        self._errands: dict[int, _Errand] = {}

    def __len__(self) -> int:
        return len(self._errands)

    def send(self, actor_id: int, points: F64) -> None:
        """Send a vehicle along a way, or a walker to its last point.

        Args:
            actor_id: of the actor; its earlier errand ends.
            points: (N, 3) x and y in m of CARLA's frame, and speed in m/s.

        Raises:
            Refusal: it is no vehicle or walker, or a client's Traffic Manager drives it.
        """
        episode = self._world.episode
        record = episode.actors.get(actor_id)
        if record.kind is BlueprintKind.VEHICLE:
            slot = episode.vehicle(actor_id)
            if episode.bodies.state["autopilot"][slot]:
                raise Refusal(f"A client's Traffic Manager drives actor {actor_id}; the page cannot send it anywhere.")
        elif record.kind is BlueprintKind.WALKER:
            episode.walker(actor_id)
            episode.walkers.refuse_dead(actor_id)
        else:
            raise Refusal(f"Only vehicles and walkers can be sent somewhere; actor {actor_id} is neither.")
        if points.ndim != 2 or points.shape[1] != 3 or not 1 <= len(points) <= MOST_POINTS:
            raise ValueError("a way has one point or more, of x, y and speed")
        if self._episode is not episode:
            self._episode, self._errands = episode, {}
        full_steer_rad = 1.0
        if record.kind is BlueprintKind.VEHICLE:
            wheels = episode.bodies.physics_control(episode.vehicle(actor_id)).wheels
            full_steer_rad = math.radians(max((wheel.max_steer_angle for wheel in wheels), default=0.0)) or 1.0
        self._errands[actor_id] = _Errand(points, full_steer_rad)

    def before_frame(self) -> None:
        """Set the controls of all actors on their way."""
        if not self._errands:
            return
        episode = self._world.episode
        if self._episode is not episode:
            self._errands = {}
            return
        places, radii, ids = _bodies(episode)
        for actor_id, errand in list(self._errands.items()):
            if actor_id not in episode.actors or self._turn(episode, actor_id, errand, places, radii, ids):
                del self._errands[actor_id]

    def _turn(
        self, episode: "Episode", actor_id: int, errand: _Errand, places: F64, radii: F64, ids: NDArray[np.int64]
    ) -> bool:
        """Set the controls of one actor; return whether its errand has ended."""
        x_m, y_m, _, _, yaw_deg, _ = (float(value) for value in episode.actors.pose[episode.actors.row(actor_id)])
        if episode.actors.get(actor_id).kind is BlueprintKind.WALKER:
            return self._walk(episode, actor_id, errand, x_m, y_m)
        slot = episode.vehicle(actor_id)
        if episode.bodies.state["autopilot"][slot]:
            self._say(f"A client's Traffic Manager has taken over actor {actor_id}.")
            return True
        points, gone = errand.points, errand.gone
        near = points[errand.at : errand.at + 20, :2] - (x_m, y_m)
        errand.at += int(np.argmin(np.hypot(*near.T)))
        left_m = float(gone[-1] - gone[errand.at])
        speed_mps = float(np.linalg.norm(episode.bodies.velocity[slot, :2]))
        if left_m < _ARRIVED_M and (speed_mps < 1.0 or errand.at == len(points) - 1):
            episode.bodies.set_control(slot, VehicleControl(brake=0.6))
            self._say(f"Actor {actor_id} has arrived.")
            return True
        soon = np.searchsorted(gone, gone[errand.at] + _LOOKS_S * speed_mps)
        wanted_mps = float(points[errand.at : soon + 1, 2].min())
        row = episode.actors.rows.view(VEHICLE_ROW)[episode.actors.row(actor_id)]
        if row["speed_limit"] > 0.0:
            wanted_mps = min(wanted_mps, float(row["speed_limit"]) / 3.6)
        has_to_wait = row["traffic_light_state"] in (TrafficLightState.RED, TrafficLightState.YELLOW)
        half = episode.actors.get(actor_id).box.extent
        free_m = _free_m(errand, half.x, half.y, places, radii, ids != actor_id)
        wanted_mps = min(wanted_mps, math.sqrt(2.0 * _SLOWS_MPS2 * max(0.0, free_m - _BEHIND_M)))
        if free_m > _BEHIND_M + 1.0:
            wanted_mps = max(wanted_mps, _CREEPS_MPS)  # the speed at the end of the way is 0
        steer_rad = _steering(errand, x_m, y_m, math.radians(yaw_deg), speed_mps, 2.0 * half.x * _WHEELBASE)
        steer = steer_rad / errand.full_steer_rad
        if has_to_wait or wanted_mps < _HALTS_MPS:
            control = VehicleControl(steer=steer, brake=0.5)
        elif wanted_mps < speed_mps:
            control = VehicleControl(steer=steer, brake=min(0.6, _BRAKES * max(0.0, speed_mps - wanted_mps - 0.2)))
        else:
            control = VehicleControl(steer=steer, throttle=min(0.6, 0.1 + _GIVES_GAS * (wanted_mps - speed_mps)))
        episode.bodies.set_control(slot, control)
        return False

    def _walk(self, episode: "Episode", actor_id: int, errand: _Errand, x_m: float, y_m: float) -> bool:
        slot = episode.walker(actor_id)
        if episode.walkers.is_dead(actor_id):
            return True
        to_x, to_y = errand.points[-1, 0] - x_m, errand.points[-1, 1] - y_m
        away_m = math.hypot(to_x, to_y)
        errand.waited_s += self._world.settings.fixed_delta_seconds or 1.0 / 30.0
        if away_m < errand.nearest_m - 0.5:
            errand.nearest_m, errand.waited_s = away_m, 0.0
        stuck = errand.waited_s > _STUCK_S
        if away_m < 0.5 or stuck:
            episode.bodies.set_walker_control(slot, WalkerControl())
            self._say(
                f"Actor {actor_id} stands before something and walks no further."
                if stuck
                else f"Actor {actor_id} has arrived."
            )
            return True
        way = Vector3D(to_x / away_m, to_y / away_m, 0.0)
        episode.bodies.set_walker_control(slot, WalkerControl(way, _WALKS_MPS))
        return False


def _bodies(episode: "Episode") -> tuple[F64, F64, NDArray[np.int64]]:
    """Return places (N, 2), half widths (N,) and ids (N,) of the actors that a vehicle must not touch, in m."""
    kinds = (BlueprintKind.VEHICLE, BlueprintKind.WALKER, BlueprintKind.PROP)
    records = [each for each in episode.actors if each.kind in kinds and each.slot != NO_BODY]
    rows = np.array([episode.actors.row(each.id) for each in records], np.intp)
    radii = np.array([max(each.box.extent.x, each.box.extent.y) for each in records])
    return episode.actors.pose[rows, :2].astype(np.float64), radii, np.array([each.id for each in records])


def _free_m(errand: _Errand, half_m: float, wide_m: float, places: F64, radii: F64, others: NDArray[np.bool_]) -> float:
    """Return how far the way before a vehicle's front is free, m; inf where nothing is near."""
    gone = errand.gone[errand.at :] - errand.gone[errand.at]
    ahead = errand.points[errand.at :, :2][gone < _SEES_M]
    near = others & (np.hypot(*(places - ahead[0]).T) < _SEES_M + 10.0)
    if not near.any():
        return math.inf
    apart = np.hypot(*(ahead[:, None] - places[near][None]).transpose(2, 0, 1))
    on_way = apart < wide_m + _BESIDE_M + np.minimum(radii[near], 1.2)[None]
    on_way[gone[: len(ahead)] < half_m] = False  # beside the vehicle itself
    hit = np.flatnonzero(on_way.any(axis=1))
    return float(gone[hit[0]] - half_m) if len(hit) else math.inf


def _steering(errand: _Errand, x_m: float, y_m: float, yaw_rad: float, speed_mps: float, base_m: float) -> float:
    """Return the angle of the wheels in rad by pure pursuit (Coulter, CMU-RI-TR-92-01)."""
    looks_m = _LOOKS_M + _LOOKS_S * speed_mps
    target = min(int(np.searchsorted(errand.gone, errand.gone[errand.at] + looks_m)), len(errand.points) - 1)
    to_x, to_y = errand.points[target, 0] - x_m, errand.points[target, 1] - y_m
    away_m = max(1.0, math.hypot(to_x, to_y))
    angle = math.atan2(to_y, to_x) - yaw_rad
    return math.atan2(2.0 * base_m * math.sin(angle), away_m)
