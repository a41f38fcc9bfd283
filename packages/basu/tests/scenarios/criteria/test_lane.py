"""Claims about keeping one's lane, and about regaining it."""

import numpy as np
import pytest

from basu.records.history import History
from basu.scenarios.criteria import KeepsLane, Regains
from fakes.drives import at, driven
from fakes.played import played


def swerved(by_m: float, *, off_road_m: float = 0.0, ticks: slice = slice(40, 60)) -> History:
    """Ten seconds along a lane 3.5 m wide, beside its middle for a while."""
    history = driven(at(10.0, 10.0))
    history.frames["lateral_m"][ticks] = by_m
    history.frames["off_lane_m"][ticks] = off_road_m
    return history


def test_in_the_middle_of_its_lane_it_keeps_it() -> None:
    said = KeepsLane().judge(played(driven(at(10.0, 4.0), lateral_m=-0.4)))
    assert said.passed is True
    assert said.sentence == "it kept within its lane; at most it was 0.40 m to the left of its route's middle at 0.00 s"


@pytest.mark.parametrize(("by_m", "passed"), [(2.2, True), (2.3, False), (-2.3, False)])
def test_half_a_metre_beyond_the_edge_is_allowed_and_no_more(by_m: float, passed: bool) -> None:  # noqa: FBT001
    said = KeepsLane().judge(played(swerved(by_m)))
    assert said.passed is passed
    assert said.measured == pytest.approx(abs(by_m) - 1.75)


def test_the_evidence_is_the_worst_frame_and_the_time_outside() -> None:
    history = swerved(2.5)
    history.frames["lateral_m"][50] = 3.0
    said = KeepsLane().judge(played(history))
    assert said.t_s == pytest.approx(2.5)
    assert said.sentence == (
        "for 1.00 s it was off its lane, up to 1.25 m beyond the edge: 3.00 m to the right of its route's middle at "
        "2.50 s at 10.00 m/s"
    )


def test_an_ego_that_passes_an_obstacle_may_leave_the_lane_but_not_the_road() -> None:
    assert KeepsLane(passing=True).judge(played(swerved(-3.5))).passed is True
    said = KeepsLane(passing=True).judge(played(swerved(-3.5, off_road_m=0.7)))
    assert (said.passed, said.criterion, said.measured) == (False, "keeps on the road", pytest.approx(0.7))


def test_off_the_road_is_off_the_lane_though_the_plan_is_near() -> None:
    assert KeepsLane().judge(played(swerved(0.2, off_road_m=0.9))).measured == pytest.approx(0.9)


def test_three_frames_outside_are_forgiven_and_what_was_before_the_phase_too() -> None:
    assert KeepsLane().judge(played(swerved(3.0, ticks=slice(40, 43)))).passed is True
    early = played(swerved(3.0, ticks=slice(0, 10)), phases_s={"conflict": 1.0})
    assert KeepsLane().judge(early).passed is False
    assert KeepsLane(since="conflict").judge(early).passed is True


def test_without_the_phase_there_is_nothing_to_judge() -> None:
    said = KeepsLane(since="resolution").judge(played(swerved(3.0), phases_s={}))
    assert said.passed is None
    assert np.isnan(said.t_s or np.nan)


def disturbed(*, back_after_s: float, yaw_deg: float = 0.0, seconds: float = 10.0) -> History:
    """Off its way by 2 m from 1 s on, and back so long after 2 s, where the disturbance ends."""
    history = driven(at(10.0, seconds))
    t_s = history.frames["t_s"]
    history.frames["lateral_m"][(t_s >= 1.0) & (t_s < 2.0 + back_after_s - 1e-6)] = -2.0
    history.frames["yaw_rad"] = np.radians(yaw_deg)
    return history


def test_regaining_is_timed_from_the_end_of_the_disturbance() -> None:
    said = Regains(2.0).judge(played(disturbed(back_after_s=1.5)))
    assert (said.passed, said.measured) == (True, pytest.approx(1.5))
    assert said.sentence == (
        "it was back 1.50 s after the disturbance, 0.00 m and 0.0° off its way; until then it was up to 2.00 m off"
    )
    assert Regains(1.0).judge(played(disturbed(back_after_s=1.5))).passed is False


def test_swinging_through_the_middle_is_not_being_back() -> None:
    history = disturbed(back_after_s=4.0)
    history.frames["lateral_m"][50:65] = 0.0  # for 0.75 s
    assert Regains().judge(played(history)).measured == pytest.approx(4.0)


def test_across_its_way_it_is_not_back_though_in_the_middle() -> None:
    said = Regains().judge(played(disturbed(back_after_s=1.0, yaw_deg=25.0)))
    assert said.passed is False
    assert "it was not back 7.95 s after the disturbance, 0.00 m and 25.0° off its way" in said.sentence


def test_without_an_end_of_the_disturbance_there_is_nothing_to_regain() -> None:
    assert Regains().judge(played(disturbed(back_after_s=1.0), phases_s={})).passed is None


def test_on_the_road_throughout_the_widest_swerve_is_reported() -> None:
    said = KeepsLane(passing=True).judge(played(swerved(-3.5)))
    assert said.sentence.endswith("at most it was 3.50 m to the left of its route's middle at 2.00 s")
