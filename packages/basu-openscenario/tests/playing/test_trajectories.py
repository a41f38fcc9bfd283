"""Trajectories and banked roads against closed forms, in the plane and in three dimensions."""

import math

import pytest

from basu_openscenario.playing.player import make_player
from basu_openscenario.reading.scenario_file import read_scenario
from basu_openscenario.roads.network_file import read_network
from basu_openscenario.roads.place import Place
from openscenario_texts import ROAD, begins, event, scenario, speed_action, story, written

BANK = '<lateralProfile><superelevation s="0" a="0.3" b="0.002" c="0" d="0"/></lateralProfile>'
RISE = '<elevationProfile><elevation s="0" a="0" b="0.05" c="0" d="0"/></elevationProfile>'


def place(x, y, **more):
    """Return the element of a place in the world."""
    rest = "".join(f' {name}="{value}"' for name, value in more.items())
    return f'<Position><WorldPosition x="{x}" y="{y}"{rest}/></Position>'


def following(shape, timing="<None/>", mode="position"):
    """Return the action that follows a shape."""
    return f"""<RoutingAction><FollowTrajectoryAction><TrajectoryRef><Trajectory name="t" closed="false"><Shape>{shape}
      </Shape></Trajectory></TrajectoryRef><TimeReference>{timing}</TimeReference>
      <TrajectoryFollowingMode followingMode="{mode}"/></FollowTrajectoryAction></RoutingAction>"""


def poses_of(folder, text):
    """Return the poses of the ego by time, rounded to milliseconds."""
    player = make_player(read_scenario(written(folder, text)))
    return {round(frame.time_s, 3): frame.poses[0] for frame in player.play()}


@pytest.fixture
def banked(tmp_path):
    """Return a network with one road that rises, and whose superelevation grows."""
    path = tmp_path / "banked.xodr"
    path.write_text(ROAD.replace("<elevationProfile/><lateralProfile/>", RISE + BANK), encoding="utf-8")
    return read_network(path)


@pytest.mark.parametrize("lane", [1, -1, -2])
@pytest.mark.parametrize("s_m", [20.0, 200.0])
def test_a_place_on_a_banked_road_is_found_again_from_the_world(banked, lane, s_m):
    there, found = Place(banked), Place(banked)
    there.set_lane("1", lane, s_m, 0.4)
    found.set_world(there.x_m, there.y_m, 0.0)
    assert (found.lane, found.s_m, found.offset_m) == (lane, pytest.approx(s_m), pytest.approx(0.4))
    assert found.z_m == pytest.approx(there.z_m)


@pytest.mark.parametrize("lane", [1, -2])
def test_a_body_on_a_banked_road_looks_along_its_way(banked, lane):
    before, here, after = Place(banked), Place(banked), Place(banked)
    for one, s_m in ((before, 99.99), (here, 100.0), (after, 100.01)):
        one.set_lane("1", lane, s_m, 0.0)
    dx, dy, dz = after.x_m - before.x_m, after.y_m - before.y_m, after.z_m - before.z_m
    assert here.p_rad == pytest.approx(-math.atan2(dz, math.hypot(dx, dy)), abs=2e-5)
    assert here.h_rad == pytest.approx(math.atan2(dy, dx), abs=2e-5)


def test_times_along_a_clothoid_are_those_of_its_length_in_each_mode(tmp_path):
    shape = (
        f'<Clothoid curvature="0.1" curvatureDot="0" length="20" startTime="0" stopTime="4">{place(50, -2)}</Clothoid>'
    )
    timing = '<Timing domainAbsoluteRelative="relative" offset="0" scale="1"/>'
    text = scenario(stories=story("Ego", event("e", following(shape, timing, "follow"))), stop=4)
    poses = poses_of(tmp_path, text)
    assert {round(pose.speed_mps, 2) for time_s, pose in poses.items() if 0.1 < time_s < 3.9} == {5.0}
    gaps = [abs(math.hypot(pose.x_m - 50, pose.y_m - 8) - 10.0) for time_s, pose in poses.items() if time_s > 0.1]
    assert max(gaps) < 1e-3  # on the circle about (50, 8)


def test_a_nurbs_curve_takes_heights_and_angles_from_its_control_points(tmp_path):
    points = "".join(
        f'<ControlPoint time="{t}" weight="1">{place(x, 0, z=z, h=h, p=p)}</ControlPoint>'
        for t, x, z, h, p in ((0, 0, 10, 0.4, 0.2), (2, 20, 14, 0.2, 0.3), (4, 40, 12, 0.0, 0.1))
    )
    knots = "".join(f'<Knot value="{value}"/>' for value in (0, 0, 0, 1, 1, 1))
    shape = f'<Nurbs order="3">{points}{knots}</Nurbs>'
    timing = '<Timing domainAbsoluteRelative="relative" offset="0" scale="1"/>'
    poses = poses_of(tmp_path, scenario(stories=story("Ego", event("e", following(shape, timing))), stop=4))
    on_it = {time_s: pose for time_s, pose in poses.items() if 0.1 < time_s < 3.9}
    for pose in on_it.values():
        t = pose.x_m / 40.0  # the control points lie evenly along x
        height_m = (1 - t) ** 2 * 10 + 2 * t * (1 - t) * 14 + t * t * 12
        assert pose.z_m == pytest.approx(height_m, abs=2e-3)
        assert 0.05 < pose.p_rad < 0.3
        assert -0.01 < pose.h_rad < 0.41
    first, last = on_it[min(on_it)], on_it[max(on_it)]
    assert (first.h_rad, first.p_rad) == pytest.approx((0.4, 0.2), abs=0.05)
    assert (last.h_rad, last.p_rad) == pytest.approx((0.0, 0.1), abs=0.05)


def test_a_polyline_with_heights_pitches_along_itself(tmp_path):
    vertices = "".join(f"<Vertex>{place(x, -2, z=z)}</Vertex>" for x, z in ((50, 1), (90, 5), (200, 5)))
    text = scenario(stories=story("Ego", event("e", following(f"<Polyline>{vertices}</Polyline>"))))
    poses = poses_of(tmp_path, text)
    rising, level = poses[2.0], poses[8.0]
    assert (rising.z_m, rising.p_rad) == pytest.approx((1 + (rising.x_m - 50) / 10, -math.atan(0.1)))
    assert (level.z_m, level.p_rad) == pytest.approx((5.0, 0.0))


def test_a_body_is_pulled_by_a_reference_point_ahead_of_its_rear_axle(tmp_path):
    vertices = f"<Vertex>{place(50, -2)}</Vertex><Vertex>{place(200, -2)}</Vertex>"
    start = f"<TeleportAction>{place(50, -2, h=0.8)}</TeleportAction>"
    init = f'<Private entityRef="Ego"><PrivateAction>{start}</PrivateAction>'
    init += f"<PrivateAction>{speed_action(10)}</PrivateAction></Private>"
    text = scenario(init=init, stories=story("Ego", event("e", following(f"<Polyline>{vertices}</Polyline>"))))
    ahead = '<Properties><Property name="refpoint_x_offset" value="3"/></Properties>'
    poses = poses_of(tmp_path, text.replace("<Properties/>", ahead))
    for time_s in (0.1, 0.5, 1.0):
        way_m = poses[time_s].x_m - 50.0
        tractrix = 2.0 * math.atan(math.tan(0.4) * math.exp(-way_m / 3.0))
        assert poses[time_s].h_rad == pytest.approx(tractrix, abs=0.01)


def test_the_box_of_a_vehicle_is_about_its_reference_point(tmp_path):
    ahead = '<Properties><Property name="refpoint_x_offset" value="3"/></Properties>'
    text = scenario(init=begins("Ego", 50, 10)).replace("<Properties/>", ahead)
    entity = read_scenario(written(tmp_path, text)).entities["Ego"]
    assert entity.box.centre_m[0] == pytest.approx(1.4 - 3.0)
