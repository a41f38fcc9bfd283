"""Claims about the round that the cooperative agent takes from its route."""

from dataclasses import replace

import numpy as np

from basu.agents.builtin.cooperative import headways_of, stop_name
from basu.routing import Route, Stop


def stop(name: str, s_m: float) -> Stop:
    return Stop(id=name, name=name, s_m=s_m, x_m=0.0, y_m=0.0, z_m=0.0, yaw_rad=0.0)


def route(end: tuple[float, float], *stops: Stop) -> Route:
    points_m = np.array([[0.0, 0.0, 0.0], [100.0, 0.0, 0.0], [*end, 0.0]])
    flat = np.zeros(3)
    return Route(
        id="0",
        town="",
        points_m=points_m,
        s_m=np.array([0.0, 100.0, 200.0]),
        yaw_rad=flat,
        lane_width_m=flat,
        speed_limit_mps=flat,
        is_junction=flat.astype(bool),
        road_id=flat.astype(int),
        lane_id=flat.astype(int),
        stops=stops,
    )


def test_a_round_is_a_closed_route_or_one_that_passes_a_stop_again() -> None:
    stops = (stop("A", 0.0), stop("B", 60.0))
    assert headways_of(route((0.0, 90.0), *stops)) is None
    closed = headways_of(route((1.0, 0.0), *stops))
    assert closed is not None
    assert closed._round_m == 201.0
    again = headways_of(route((0.0, 90.0), *stops, stop("A/2", 150.0), stop("B/2", 190.0)))
    assert again is not None
    assert again._round_m == 150.0
    assert headways_of(replace(route((1.0, 0.0)), stops=())) is None
    assert stop_name("S2N/3") == "S2N"
