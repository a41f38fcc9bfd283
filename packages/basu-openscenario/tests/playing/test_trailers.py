"""Trailers in the kinematic mode against closed forms, their connection, and what bad ones get."""

import math
import re

import pytest

from basu.errors import ScenarioError
from basu_openscenario.playing.player import make_player
from basu_openscenario.reading.scenario_file import read_scenario
from basu_openscenario.staging.refusals import check_staged
from openscenario_texts import at_time, begins, event, scenario, story, vehicle, written

HITCH, COUPLER = '<TrailerHitch dx="-1.2"/>', '<TrailerCoupler dx="3.25"/>'


def parts(name, *more):
    """Return a vehicle with further elements, such as a hitch."""
    return vehicle(name).replace("</Vehicle>", f"{''.join(more)}</Vehicle>")


def towing(name, trailer, *more):
    """Return a vehicle that tows another entity."""
    return parts(name, HITCH, f'<Trailer><TrailerRef entityRef="{trailer}"/></Trailer>', *more)


def player_of(folder, **rest):
    """Return the player of a file that is written with this content."""
    return make_player(read_scenario(written(folder, scenario(**{"stop": 20, "revision": (1, 3), **rest}))))


def circle(radius_m):
    """Return the action that follows a full circle to the left, from the place of the entity on."""
    return f"""<RoutingAction><FollowTrajectoryAction><Trajectory name="circle" closed="false"><Shape>
      <Clothoid curvature="{1.0 / radius_m}" curvatureDot="0" length="{2.0 * math.pi * radius_m}"><Position>
        <WorldPosition x="100" y="-1.75" h="0"/></Position></Clothoid></Shape></Trajectory>
      <TimeReference><None/></TimeReference><TrajectoryFollowingMode followingMode="position"/>
    </FollowTrajectoryAction></RoutingAction>"""


def test_a_trailer_begins_in_a_line_behind_its_vehicle(tmp_path):
    player = player_of(tmp_path, entities=towing("Ego", "T") + parts("T", COUPLER), init=begins("Ego", 100, 10))
    pose = next(player.play()).poses[1]
    assert (pose.x_m, pose.y_m, pose.h_rad) == pytest.approx((100.0 - 1.2 - 3.25, -1.75, 0.0))
    assert pose.speed_mps == pytest.approx(10.0)


def test_a_trailer_in_a_circle_keeps_the_angle_of_the_closed_form(tmp_path):
    player = player_of(
        tmp_path,
        entities=towing("Ego", "T") + parts("T", COUPLER),
        init=begins("Ego", 100, 5),
        stories=story("Ego", event("turn", circle(15.0), at_time(0))),
    )
    last = list(player.play(0.01, 15.0))[-1]
    ego, trailer = last.poses
    # the hitch goes in a circle of radius √(15² + 1.2²), and the axle of the trailer in one that its drawbar touches
    hitch_m = math.hypot(15.0, 1.2)
    axle_m = math.sqrt(hitch_m**2 - 3.25**2)
    middle_m = ego.x_m - 15.0 * math.sin(ego.h_rad), ego.y_m + 15.0 * math.cos(ego.h_rad)
    assert math.dist(middle_m, (trailer.x_m, trailer.y_m)) == pytest.approx(axle_m, abs=0.01)
    angle_rad = math.atan2(1.2, 15.0) + math.atan2(3.25, axle_m)
    assert math.remainder(ego.h_rad - trailer.h_rad, math.tau) == pytest.approx(angle_rad, abs=2e-3)


def test_a_trailer_that_starts_askew_follows_the_tractrix(tmp_path):
    player = player_of(tmp_path, entities=towing("Ego", "T") + parts("T", COUPLER), init=begins("Ego", 100, 2), stop=30)
    next(player.play())
    trailer = player.world.mover("T")
    first_rad = 0.9
    hitch_m = 98.8
    trailer.place.set_world(hitch_m - 3.25 * math.cos(first_rad), -1.75 - 3.25 * math.sin(first_rad), first_rad)
    for _ in range(200):
        player.step(0.01)
    way_m = 4.0  # two seconds at 2 m/s
    expected_rad = 2.0 * math.atan(math.tan(first_rad / 2.0) * math.exp(-way_m / 3.25))
    assert math.remainder(trailer.place.h_rad, math.tau) == pytest.approx(expected_rad, abs=2e-3)


def test_a_trailer_that_is_described_inside_its_vehicle_is_called_after_it(tmp_path):
    inside = parts("", COUPLER, HITCH).replace("ScenarioObject", "Trailer")
    player = player_of(tmp_path, entities=parts("Ego", HITCH, f"<Trailer>{inside}</Trailer>"))
    assert [pose.name for pose in next(player.play()).poses] == ["Ego", "Ego+"]


def test_a_trailer_is_connected_and_disconnected_by_actions(tmp_path):
    def action(name, inside, when):
        return event(name, f"<TrailerAction>{inside}</TrailerAction>", at_time(when))

    events = action("on", '<ConnectTrailerAction trailerRef="T"/>', 2), action("off", "<DisconnectTrailerAction/>", 6)
    player = player_of(
        tmp_path,
        entities=parts("Ego", HITCH) + parts("T", COUPLER),
        init=begins("Ego", 100, 5) + begins("T", 60, 0),
        stories=story("Ego", *events),
    )
    poses = {round(frame.time_s, 2): frame.poses for frame in player.play(0.01, 10.0)}
    assert poses[1.5][1].x_m == pytest.approx(60.0)
    ego, trailer = poses[4.0]
    assert ego.x_m - trailer.x_m == pytest.approx(1.2 + 3.25)
    assert player.world.mover("T").tow is None
    assert poses[9.0][1].x_m < poses[9.0][0].x_m  # it rolls on with its last speed


@pytest.mark.parametrize(
    ("entities", "sentence"),
    [
        (towing("Ego", "None"), "the trailer 'None' does not exist; add an entity of this name"),
        (towing("Ego", "T").replace(HITCH, "") + parts("T", COUPLER), "'Ego' has no hitch for a trailer; add"),
        (towing("Ego", "T") + vehicle("T"), "'T' has no coupler ahead of its axle; add <TrailerCoupler"),
        (towing("Ego", "T") + parts("T", '<TrailerCoupler dx="-1"/>'), "'T' has no coupler ahead of its axle"),
        (towing("Ego", "T") + towing("B", "T") + parts("T", COUPLER), "tow the same trailer 'T'"),
        (towing("Ego", "T", COUPLER) + towing("T", "Ego", COUPLER), "'Ego' is among its own trailers"),
        (parts("Ego", HITCH, "<Trailer/>"), "<Trailer> has no <Trailer>; add one"),
        (
            "".join(towing(f"{n}" if n else "Ego", f"{n + 1}", COUPLER) for n in range(10)) + parts("10", COUPLER),
            "more than 8 trailers; remove some",
        ),
    ],
)
def test_bad_trailers_are_named_with_file_and_line(tmp_path, entities, sentence):
    with pytest.raises(ScenarioError) as caught:
        player_of(tmp_path, entities=entities)
    assert re.match(r"[^\n]*test\.xosc:\d+: ", str(caught.value))
    assert sentence in str(caught.value)


def test_an_action_on_a_trailer_that_does_not_exist_is_named(tmp_path):
    connect = event("on", '<TrailerAction><ConnectTrailerAction trailerRef="T"/></TrailerAction>', at_time(1))
    with pytest.raises(ScenarioError, match=r"test\.xosc:\d+: the entity 'T' does not exist"):
        player_of(tmp_path, entities=parts("Ego", HITCH), stories=story("Ego", connect))


def test_the_simulator_refuses_trailers_with_file_and_line(tmp_path):
    text = scenario(entities=towing("Ego", "T") + parts("T", COUPLER), revision=(1, 3))
    with pytest.raises(ScenarioError, match=r"test\.xosc:\d+: 'Ego' tows a trailer, which is not supported in the sim"):
        check_staged(read_scenario(written(tmp_path, text)))
