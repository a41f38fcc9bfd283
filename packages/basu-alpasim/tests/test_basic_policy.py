"""Claims about ``basic`` as a policy: the judge is the loop of carla-driver-interface, as it comes, over gRPC."""

import math
from collections.abc import Iterator

import numpy as np
import pytest
from carla_driver_interface.geometry import Pose
from carla_driver_interface.server import serving
from carla_driver_interface.testing import FakeCamera, FakeLoop, LoopResult

from basu.agents.builtin.scene import VehicleGeometry
from basu_alpasim.basic_policy import OFFERED, BasicPolicy, Known, sent_route
from basu_alpasim.serve_command import AGENTS

CAR = VehicleGeometry(wheelbase_m=2.87, rear_axle_m=1.44, front_m=2.4, rear_m=2.4, half_width_m=1.08)
CRUISE_MPS = 8.0


@pytest.fixture(params=["carla", "alpasim"])
def address(request: pytest.FixtureRequest) -> Iterator[str]:
    """The address of the policy without a route of its own."""
    with serving(BasicPolicy(Known(CAR, None, CRUISE_MPS)), port=0, host="127.0.0.1", mode=request.param) as port:
        yield f"127.0.0.1:{port}"


def judged(address: str, steps: int, **start: float) -> LoopResult:
    """Return what the unmodified loop of carla-driver-interface saw."""
    with FakeLoop(address, [FakeCamera(width=64, height=36)], **start) as loop:
        return loop.run(steps)


def test_it_keeps_the_lane_and_reaches_its_speed(address: str) -> None:
    result = judged(address, 200)
    assert result.steps == 200
    assert not result.terminated_by_policy
    assert np.abs(result.lateral_offsets_m).max() < 0.01
    assert result.speeds_mps[-1] == pytest.approx(CRUISE_MPS, abs=0.2)


def test_it_gathers_speed_in_comfort(address: str) -> None:
    speeds = np.array(judged(address, 150).speeds_mps)
    assert np.diff(speeds).max() / 0.1 < 1.6  # m/s²


def test_the_route_beside_the_vehicle_is_regained(address: str) -> None:
    result = judged(address, 30, initial_lateral_offset_m=0.8, initial_speed_mps=5.0)
    assert abs(result.lateral_offsets_m[-1]) < 0.1


@pytest.mark.parametrize("agent", sorted(OFFERED))
def test_each_offered_agent_keeps_the_lane_and_its_own_speed(agent: str) -> None:
    with serving(BasicPolicy(Known(CAR, None, CRUISE_MPS, agent)), port=0, host="127.0.0.1", mode="carla") as port:
        result = judged(f"127.0.0.1:{port}", 200)
    assert not result.terminated_by_policy
    assert np.abs(result.lateral_offsets_m).max() < 0.02
    expected_mps = min(CRUISE_MPS, OFFERED[agent].cap_mps)
    assert result.speeds_mps[-1] == pytest.approx(expected_mps, abs=0.3)


def test_the_command_offers_what_there_is() -> None:
    assert set(AGENTS) == set(OFFERED)


def test_two_sessions_at_once_do_not_mix(address: str) -> None:
    assert judged(address, 40).lateral_offsets_m.tolist() == judged(address, 40).lateral_offsets_m.tolist()


def test_nan_at_the_end_of_a_route_is_left_out() -> None:
    points = np.full((20, 3), math.nan)
    points[:3] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [8.0, 0.0, 0.0]]
    route = sent_route(Pose.identity(), points)
    assert route is not None
    assert route.length_m == pytest.approx(8.0)


@pytest.mark.parametrize("count", [0, 1])
def test_too_few_points_are_no_route(count: int) -> None:
    assert sent_route(Pose.identity(), np.zeros((count, 3))) is None
