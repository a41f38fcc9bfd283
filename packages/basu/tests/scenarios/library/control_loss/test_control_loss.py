"""Claims about losing control: patches, bumps and jitter of the controls, offline."""

import math
from collections.abc import Callable
from itertools import pairwise

import pytest
from py_trees.common import Status

from basu.errors import ScenarioError
from basu.scenarios.cases import open_library
from basu.scenarios.paths import Path
from basu.scenarios.scenario import Scenario, compose, set_on
from basu.scenarios.stage import Controls, Pose
from basu.testing import OfflineStage, Rehearsal, StageCommand, offline_place, rehearse, steady
from fakes.steered_course import steered

Laid = Callable[..., Scenario]


LIBRARY = open_library()


STRAIGHT_AHEAD = Controls(0.5, 0.0, 0.0)


def names(*kinds: str) -> list[str]:
    return [case.name for case in LIBRARY.cases if case.type in kinds]


def frictions(played: Rehearsal) -> list[tuple[Pose, float, float]]:
    return [command.details for command in played.commands if command.what == "friction"]  # type: ignore[misc]


@pytest.mark.parametrize("name", names("ControlLoss"))
def test_control_is_lost_to_both_sides_by_turns(laid: Laid, name: str) -> None:
    scenario = laid(name, jitter="0")
    sign = 1.0 if scenario.choice("side") == "right" else -1.0
    told = steered(scenario)
    firsts = [
        next(steer for s_m, steer in told if s_m >= place_m and abs(steer) > 0.01) for place_m in scenario.places_m
    ]
    assert [math.copysign(1.0, steer) for steer in firsts] == [sign, -sign, sign]


def test_wet_patches_lie_on_the_ego_way_where_its_controls_are_off(laid: Laid) -> None:
    scenario = laid("control_loss_1", friction="0.2")
    patches = frictions(rehearse(scenario, steady(6.0)))
    assert [friction for _, _, friction in patches] == [0.2] * 3
    way = Path.of_route(scenario.place.route)
    for (pose, radius_m, _), place_m in zip(patches, scenario.places_m, strict=True):
        near = way.nearest(pose.x_m, pose.y_m)
        assert abs(near.right_m) < 0.1
        assert near.s_m - radius_m == pytest.approx(place_m, abs=0.5)


def test_bumps_lie_across_the_lane_so_that_no_ego_in_its_lane_goes_round_one(laid: Laid) -> None:
    for name in ("control_loss_2", "control_loss_4"):
        scenario = laid(name)
        assert not frictions(rehearse(scenario, steady(6.0)))
        bumps = scenario.actors()
        assert {spec.blueprint for spec in bumps} == {"static.prop.dirtdebris01"}
        way = Path.of_route(scenario.place.route)
        for spec, place_m in zip(bumps, scenario.places_m, strict=True):
            near = way.nearest(spec.pose.x_m, spec.pose.y_m)
            assert abs(near.right_m) < 0.1
            assert near.s_m == pytest.approx(place_m + 3.0, abs=0.5)
            lane_m = scenario.place.width_m(near.s_m - scenario.place.trigger_s_m)
            assert lane_m / 2.0 < 0.93 + 1.0  # half the bump's longer side and half the ego's width


def test_a_bump_disturbs_steering_and_throttle_while_the_ego_is_over_it_and_not_before(laid: Laid) -> None:
    scenario = laid("control_loss_2", side="right", pull="0.3", jitter="0.05", surge="0.2")
    stage = OfflineStage(scenario.place, scenario.actors(), steady(6.0))
    tree = compose(scenario)
    set_on(tree, stage)
    over, clear = [], []
    while tree.root.root.status != Status.SUCCESS and stage.time_s < scenario.timeout_s:
        tree.root.tick()
        ego, bump = stage.ego, stage.body("bump 1")
        between_m = math.hypot(ego.x_m - bump.x_m, ego.y_m - bump.y_m)
        controls = stage.controls(STRAIGHT_AHEAD)
        (over if between_m < 2.5 else clear if stage.ego_s_m < scenario.places_m[1] and between_m > 4.0 else []).append(
            controls
        )
        stage.advance()
    assert {(c.throttle, c.steer) for c in clear} == {(0.5, 0.0)}
    steer, throttle = [c.steer for c in over], [c.throttle for c in over]
    assert 0.2 < sum(steer) / len(steer) < 0.4
    assert len(set(steer)) > 5
    assert len(set(throttle)) > 5


def test_an_ego_beside_a_bump_is_not_disturbed(laid: Laid) -> None:
    scenario = laid("control_loss_2")
    aside = [spec._replace(pose=scenario.place.at(300.0)) for spec in scenario.actors()]
    stage = OfflineStage(scenario.place, aside, steady(6.0))
    tree = compose(scenario)
    set_on(tree, stage)
    for _ in range(200):
        tree.root.tick()
        assert stage.controls(STRAIGHT_AHEAD) == STRAIGHT_AHEAD
        stage.advance()


def test_the_same_seed_jitters_alike_and_another_does_not(laid: Laid) -> None:
    scenario = laid("control_loss_1")
    assert steered(scenario, seed=4) == steered(laid("control_loss_1"), seed=4)
    assert steered(scenario, seed=4) != steered(scenario, seed=5)


@pytest.mark.parametrize("name", names("SlipperyStop", "BendDeparture"))
def test_the_slippery_road_has_no_gaps_and_reaches_to_its_end(laid: Laid, name: str) -> None:
    scenario = laid(name)
    way = Path.of_route(scenario.place.route)
    patches = frictions(rehearse(scenario, steady(6.0)))
    reach_m = sorted((way.nearest(pose.x_m, pose.y_m).s_m, radius_m) for pose, radius_m, _ in patches)
    for (before_m, radius_m), (after_m, _) in pairwise(reach_m):
        assert after_m - before_m < 2.0 * radius_m
    if type(scenario).__name__ == "SlipperyStop":
        from_m, to_m = scenario.slippery_from_m, scenario.line_m
    else:
        from_m, to_m, _ = scenario.bend
    assert reach_m[0][0] - reach_m[0][1] <= from_m + 0.5
    assert reach_m[-1][0] + reach_m[-1][1] >= to_m - 0.5


def test_the_pull_before_a_stop_line_ends_at_the_line(laid: Laid) -> None:
    scenario = laid("slippery_stop_1", jitter="0")
    off_m = [s_m for s_m, steer in steered(scenario) if steer != 0.0]
    assert off_m[0] == pytest.approx(scenario.slippery_from_m, abs=0.5)
    assert off_m[-1] == pytest.approx(scenario.line_m, abs=0.5)


def test_a_route_without_a_stop_sign_or_a_bend_is_refused() -> None:
    place = offline_place([(0, 0), (100, 0)])
    for kind, lacks in (("SlipperyStop", "no stop sign"), ("BendDeparture", "no bend")):
        scenario = next(s for s in LIBRARY.scenarios if s.__name__ == kind)
        values = {parameter.name: parameter.default for parameter in scenario.parameters}
        with pytest.raises(ScenarioError, match=lacks):
            compose(scenario(place, values))


def test_what_is_done_is_reported_in_the_tree(laid: Laid) -> None:
    played = rehearse(laid("control_loss_1"), steady(6.0))
    lost = played.tree.phases["conflict"].children[0]
    assert [node.name for node in lost.children[:2]] == ["controls jitter for 1.5 s", "ego passes place 2"]
    assert isinstance(played.commands[0], StageCommand)
