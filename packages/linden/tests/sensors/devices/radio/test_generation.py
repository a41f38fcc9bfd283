"""The generation rules of EN 302 637-2, driven frame by frame."""

from collections.abc import Callable
from itertools import pairwise

import pytest

from linden.protocol.values.space import Vector3D
from linden.sensors.devices.radio.generation import Generation, StationMotion, generate
from linden.sensors.devices.radio.spec import CamSpec

FRAME_S = 0.05
USUAL = CamSpec()


def sent(
    motion: Callable[[float], StationMotion | None], seconds: float, spec: CamSpec = USUAL
) -> list[tuple[float, bool]]:
    """Times of the messages, and which of them have the low-frequency container."""
    state, found = Generation(), []
    for frame in range(round(seconds / FRAME_S)):
        now_s = frame * FRAME_S
        due, state = generate(state, spec, motion(now_s), now_s)
        if due.message:
            found.append((round(now_s, 6), due.facts))
    assert state.made == len(found)
    return found


def gaps(found: list[tuple[float, bool]]) -> list[float]:
    return [round(later - earlier, 6) for (earlier, _), (later, _) in pairwise(found)]


def at_rest(_now_s: float) -> StationMotion:
    return StationMotion(Vector3D(), 0.0, 0.0)


def driving(speed_mps: float) -> Callable[[float], StationMotion]:
    return lambda now_s: StationMotion(Vector3D(x=speed_mps * now_s), 0.0, speed_mps)


def test_at_rest_there_is_one_message_a_second_and_each_has_the_slow_container() -> None:
    found = sent(at_rest, 10.0)
    assert found == [(float(second), True) for second in range(10)]


@pytest.mark.parametrize(("speed_mps", "gap_s"), [(3.0, 1.0), (11.0, 0.4), (21.0, 0.2), (30.0, 0.15), (60.0, 0.1)])
def test_driving_there_is_one_for_more_than_four_metres(speed_mps: float, gap_s: float) -> None:
    assert set(gaps(sent(driving(speed_mps), 10.0))) == {gap_s}


def test_the_slow_container_comes_each_half_second() -> None:
    found = sent(driving(60.0), 5.0)
    assert [time_s for time_s, facts in found if facts] == [0.5 * step for step in range(10)]


def test_braking_hard_and_turning_fast_call_for_messages() -> None:
    assert set(gaps(sent(lambda now_s: StationMotion(Vector3D(), 0.0, 6.0 * now_s), 4.0))) == {0.1}
    assert set(gaps(sent(lambda now_s: StationMotion(Vector3D(), (350.0 + 25.0 * now_s) % 360.0, 0.0), 4.0))) == {0.2}


def test_a_short_interval_is_kept_for_three_messages() -> None:
    def jump(now_s: float) -> StationMotion:
        return StationMotion(Vector3D(x=5.0 if now_s > 0.16 else 0.0), 0.0, 0.0)

    assert [time_s for time_s, _ in sent(jump, 4.0)] == [0.0, 0.2, 0.4, 0.6, 0.8, 1.8, 2.8, 3.8]


def test_a_fixed_rate_ignores_what_the_vehicle_does() -> None:
    assert set(gaps(sent(at_rest, 3.0, CamSpec(least_interval_s=0.2, fixed_rate=True)))) == {0.2}


def test_a_road_side_unit_keeps_the_greatest_interval_and_has_no_slow_container() -> None:
    found = sent(lambda _: None, 3.0, CamSpec(greatest_interval_s=0.5))
    assert found == [(0.5 * step, False) for step in range(6)]


def test_a_long_frame_has_one_message() -> None:
    state, made = Generation(), 0
    for frame in range(5):
        due, state = generate(state, CamSpec(), StationMotion(Vector3D(x=100.0 * frame), 0.0, 0.0), 2.0 * frame)
        made += due.message
    assert made == 5
