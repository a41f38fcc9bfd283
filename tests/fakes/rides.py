"""Records of rides that never took place, for claims about what passengers feel: poses and others by formula."""

from collections.abc import Callable, Sequence

import numpy as np

from basu.records.history import FRAME, Facts, History, Recorder
from basu.records.history.model import NO_LIGHT, OTHER
from basu.routing import Route
from fakes.drives import STEP_S, VEHICLE, straight_route

Row = dict[str, float]


def ride(
    seconds: float,
    state: Callable[[float], Row],
    *,
    others: Sequence[tuple[int, Callable[[float], Row]]] = (),
    sizes: dict[int, tuple[float, float]] | None = None,
    route: Route | None = None,
) -> History:
    """The record of a vehicle whose frame at each time ``state`` gives, columns by name, 0 where it gives none."""
    recorder = Recorder()
    for tick in range(round(seconds / STEP_S)):
        t_s = tick * STEP_S
        row = {"tick": tick, "t_s": t_s, "route_light": NO_LIGHT, "traffic_light_state": NO_LIGHT, **state(t_s)}
        recorder.frame([float(row.get(name, 0.0)) for name in FRAME.names or ()])
        near = [{"tick": tick, "id": key, **where(t_s)} for key, where in others]
        recorder.others([[float(one.get(name, 0.0)) for name in OTHER.names or ()] for one in near])
    facts = Facts(
        step_s=STEP_S,
        vehicle=VEHICLE,
        route=route or straight_route(),
        actor_types={key: "vehicle.audi.tt" for key, _ in others},
        actor_sizes=sizes or {key: (2.0, 0.9) for key, _ in others},
    )
    return recorder.history(facts)


def eastward(speed_mps: Callable[[float], float], seconds: float, **more: float) -> Callable[[float], Row]:
    """Along the straight road at a speed that changes with time, ``more`` columns held."""
    t_s = np.arange(0.0, seconds + 1.0, STEP_S)
    v_mps = np.array([speed_mps(t) for t in t_s.tolist()])
    x_m = np.concatenate([[0.0], np.cumsum(0.5 * (v_mps[1:] + v_mps[:-1]) * STEP_S)])

    def state(at_s: float) -> Row:
        x = float(np.interp(at_s, t_s, x_m))
        return {"x_m": x, "route_s_m": x, "velocity_x_mps": float(np.interp(at_s, t_s, v_mps)), **more}

    return state


def braked(from_mps: float, at_s: float, braking_mps2: float) -> Callable[[float], float]:
    """A speed that is held until ``at_s`` and then falls evenly to rest."""
    return lambda t_s: max(0.0, from_mps - max(0.0, t_s - at_s) * braking_mps2)


def circling(radius_m: float, speed_mps: float) -> Callable[[float], Row]:
    """Round to the right at a constant speed, from a heading east."""

    def state(t_s: float) -> Row:
        yaw_rad = speed_mps / radius_m * t_s
        return {
            "x_m": radius_m * np.sin(yaw_rad),
            "y_m": radius_m * (1.0 - np.cos(yaw_rad)),
            "yaw_rad": float(np.arctan2(np.sin(yaw_rad), np.cos(yaw_rad))),
            "velocity_x_mps": speed_mps * np.cos(yaw_rad),
            "velocity_y_mps": speed_mps * np.sin(yaw_rad),
        }

    return state


def moving(x_m: float, y_m: float, velocity_x_mps: float, velocity_y_mps: float) -> Callable[[float], Row]:
    """Somebody else who goes straight on, nose first."""
    yaw_rad = float(np.arctan2(velocity_y_mps, velocity_x_mps))
    return lambda t_s: {
        "x_m": x_m + velocity_x_mps * t_s,
        "y_m": y_m + velocity_y_mps * t_s,
        "yaw_rad": yaw_rad,
        "velocity_x_mps": velocity_x_mps,
        "velocity_y_mps": velocity_y_mps,
    }
