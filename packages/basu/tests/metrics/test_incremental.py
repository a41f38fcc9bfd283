"""Claims about infractions so far: at every moment they are those of the record until then, and a look stays cheap."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from basu.metrics.incremental import SoFar
from basu.metrics.score import infractions, score
from basu.metrics.scoring import Scoring
from basu.records.history import FRAME, Collision, History, Recorder
from fakes.drives import at, driven, hit, ramp, stop_sign, straight_route, traffic_light

RED = 0


def looked_at(history: History, every: int, *, compare: bool = False) -> SoFar:
    """The drive recorded once more, looked at every so many ticks."""
    recorder, so_far = Recorder(), SoFar(Scoring())
    waiting = list(history.collisions)
    for tick, row in enumerate(history.frames.tolist()):
        recorder.frame(row)
        while waiting and waiting[0].tick <= tick:
            recorder.collision(waiting.pop(0))
        if tick % every == every - 1:
            so_far.advance(lambda first: recorder.window(first, history.facts))
            if compare:
                until_now = recorder.history(history.facts)
                assert so_far.infractions == infractions(until_now)
                assert so_far.scores == pytest.approx(score(until_now, Scoring()))
    so_far.advance(lambda first: recorder.window(first, history.facts))
    return so_far


speeds = st.lists(
    st.tuples(st.sampled_from([0.0, 0.05, 2.0, 10.0, 11.5, 13.0, 15.0]), st.sampled_from([0.1, 0.4, 1.0, 2.5, 4.0])),
    min_size=1,
    max_size=12,
)


@settings(max_examples=25)
@given(speeds, st.lists(st.integers(0, 1200), max_size=8), st.integers(1, 45), st.integers(0, 200))
def test_what_is_reported_while_driving_is_what_the_record_tells(
    pieces: list[tuple[float, float]], contacts: list[int], every: int, red_until: int
) -> None:
    route = straight_route(400.0, controls=(stop_sign(30.0), traffic_light(70.0), stop_sign(90.0, "8")))
    speeds_mps = [value for speed_mps, seconds in pieces for value in at(speed_mps, seconds)]
    messages = [hit(tick) for tick in sorted(contacts) if tick < len(speeds_mps)]
    history = driven(speeds_mps, route=route, collisions=messages)
    history.frames["route_light"] = np.where(history.frames["tick"] < red_until, RED, 2)
    so_far = looked_at(history, every)
    assert so_far.infractions == infractions(history)
    assert so_far.scores == pytest.approx(score(history, Scoring()))


def test_it_holds_at_every_moment_of_a_drive_full_of_infractions() -> None:
    route = straight_route(400.0, controls=(stop_sign(40.0), traffic_light(80.0)))
    speeds_mps = [*at(13.0, 6.0), *ramp(13.0, 0.0, 2.0), *at(0.0, 3.0), *ramp(0.0, 14.0, 4.0), *at(14.0, 6.0)]
    history = driven(speeds_mps, route=route, collisions=[hit(tick) for tick in range(100, 130)])
    history.frames["route_light"] = RED
    found = looked_at(history, 7, compare=True).infractions
    assert {event.kind.value for event in found} == {"speeding", "stop_sign", "red_light", "collision_static"}


def test_a_contact_heard_half_a_second_late_is_reported_all_the_same() -> None:
    history = driven(at(5.0, 20.0))
    recorder, so_far = Recorder(), SoFar(Scoring())
    for tick, row in enumerate(history.frames.tolist()):
        recorder.frame(row)
        if tick == 110:
            recorder.collision(Collision(tick=100, other_id=0, other_type="static.poles", impulse_ns=(1.0, 0.0, 0.0)))
        so_far.advance(lambda first: recorder.window(first, history.facts))
    assert [event.tick for event in so_far.infractions] == [100]


def test_a_look_late_in_a_drive_judges_no_more_than_the_first_ones_did() -> None:
    route = straight_route(20000.0)
    history = driven([*at(13.0, 2.0), *at(9.0, 300.0)], route=route)
    recorder, so_far = Recorder(), SoFar(Scoring())
    judged = []
    for tick, row in enumerate(history.frames.tolist()):
        recorder.frame(row)
        if tick % 20 == 19:
            frames = []

            def window(first: int, frames: list[int] = frames) -> History:
                found = recorder.window(first, history.facts)
                frames.append(len(found.frames))
                return found

            so_far.advance(window)
            judged.append(sum(frames))
    assert max(judged[10:]) <= max(judged[:10])


def test_the_record_is_the_same_whether_or_not_an_actor_looked() -> None:
    history = driven(ramp(0.0, 12.0, 10.0), collisions=[hit(50)])
    quiet, watched = Recorder(), Recorder()
    for tick, row in enumerate(history.frames.tolist()):
        quiet.frame(row)
        watched.frame(row)
        if tick % 13 == 0:
            watched.window(max(0, tick - 5), history.facts)
    a, b = quiet.history(history.facts).frames, watched.history(history.facts).frames
    assert a.dtype == b.dtype == FRAME
    assert a.tobytes() == b.tobytes()
