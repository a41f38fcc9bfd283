"""Actions on traffic in the kinematic mode: how many vehicles appear, where, how fast, and when they leave."""

import collections
import math
from itertools import pairwise

import pytest

from basu.errors import ScenarioError
from basu_openscenario.playing.areas import inside_polygon, stretch_pieces
from basu_openscenario.playing.player import make_player
from basu_openscenario.playing.relations import gaps_m
from basu_openscenario.reading.scenario_file import read_scenario
from basu_openscenario.reading.traffic import MOST_VEHICLES, RoadStretch
from basu_openscenario.reading.traffic_reading import SIZES_M
from basu_openscenario.staging.bodies import VEHICLES, blueprint_of
from openscenario_texts import at_time, begins, event, scenario, story, vehicle, written
from traffic_texts import area, categories, polygon, sink, source, stop, swarm


def player_of(folder, init="", *, seed=0, **rest):
    """Return the player of a file with these init actions, in which the ego stands at 900 m."""
    text = scenario(init=init + begins("Ego", 900, 0), **{"stop": 30, "revision": (1, 3), **rest})
    return make_player(read_scenario(written(folder, text)), seed=seed)


def traffic_of(frame):
    """Return the poses of the vehicles of traffic by name."""
    return {pose.name: pose for pose in frame.poses if pose.name.startswith("traffic-")}


def played(player, step_s=0.05, longest_s=30.0):
    """Return the frames of a scenario that is played in steps."""
    return list(player.play(step_s, longest_s))


def test_a_source_brings_vehicles_at_its_rate(tmp_path):
    frames = played(player_of(tmp_path, source(100, rate=0.5, speed=10)))
    first = {}
    for frame in frames:
        for name in traffic_of(frame):
            first.setdefault(name, frame.time_s)
    assert len(first) == 16  # one at once, and one each two seconds for thirty
    times = list(first.values())
    assert [round(b - a, 1) for a, b in pairwise(times)] == [2.0] * 15


def test_vehicles_of_a_source_without_a_radius_begin_in_its_lane_with_its_speed(tmp_path):
    frames = played(player_of(tmp_path, source(100, lane=-2, rate=0.5, speed=12)), longest_s=2.0)
    pose = traffic_of(frames[1])["traffic-1"]
    assert (pose.x_m, pose.y_m) == pytest.approx((100.6, -5.25))  # a step of 50 ms at 12 m/s
    assert pose.speed_mps == pytest.approx(12.0)


def test_vehicles_of_a_source_appear_within_its_radius_along_their_lanes(tmp_path):
    player = player_of(tmp_path, source(500, rate=20, radius=120, speed=10))
    poses = traffic_of(list(player.play(0.05, 1.0))[-1]).values()
    assert len(poses) > 8
    assert {round(pose.y_m, 2) for pose in poses} == {1.75, -1.75, -5.25}
    for pose in poses:
        assert math.dist((pose.x_m, pose.y_m), (500.0, -1.75)) <= 120.0 + 10.0
        assert math.cos(pose.h_rad) == pytest.approx(-1.0 if pose.y_m > 0.0 else 1.0)


def test_without_a_speed_vehicles_drive_as_the_road_posts(tmp_path):
    frames = played(player_of(tmp_path, source(100, rate=0.2, speed=None)), longest_s=3.0)
    assert traffic_of(frames[-1])["traffic-1"].speed_mps == pytest.approx(50.0 / 3.6)


def test_a_vehicle_without_room_waits_and_none_touches_another(tmp_path):
    player = player_of(tmp_path, source(100, rate=20, speed=10))
    smallest = math.inf
    for _ in player.play(0.05, 30.0):
        movers = [driver.mover for driver in player.world.traffic.drivers.values()]
        movers.append(player.world.mover("Ego"))
        for nth, one in enumerate(movers):
            for other in movers[nth + 1 :]:
                along, aside, touches = gaps_m(one, other)
                assert not touches
                smallest = min(smallest, abs(along) or abs(aside))
    assert 10 < player.world.traffic.brought < 40
    assert smallest > 0.5


def test_traffic_stops_behind_a_vehicle_that_stands(tmp_path):
    player = player_of(tmp_path, source(700, rate=0.1, speed=15))
    last = played(player)[-1]
    pose = traffic_of(last)["traffic-1"]
    front_m = pose.x_m + 0.28 * 4.6 + 2.3
    assert pose.speed_mps == pytest.approx(0.0, abs=0.3)
    assert 900.0 + 1.4 - 2.2 - front_m == pytest.approx(2.0, abs=1.0)  # the jam distance


def test_traffic_leaves_at_the_end_of_the_road(tmp_path):
    player = player_of(tmp_path, source(940, lane=-2, rate=0.5, speed=20))
    counts = [len(traffic_of(frame)) for frame in played(player)]
    assert player.world.traffic.brought == 16
    assert max(counts) <= 3


def test_a_sink_removes_the_vehicles_of_traffic_and_no_entity_of_the_file(tmp_path):
    player = player_of(tmp_path, source(800, lane=-2, rate=0.5, speed=10) + sink(900, radius=15))
    frames = played(player)
    assert max(pose.x_m for frame in frames for pose in traffic_of(frame).values()) < 890.0
    assert player.world.traffic.brought == 16
    assert any(pose.name == "Ego" for pose in frames[-1].poses)


def test_a_sink_with_a_rate_removes_no_more_than_that(tmp_path):
    player = player_of(tmp_path, source(100, lane=-2, rate=1, speed=10) + sink(150, radius=1000, rate=0.25))
    removed = [player.world.traffic.brought - len(traffic_of(frame)) for frame in player.play(0.05, 20.0)]
    assert removed[-1] in {5, 6}
    assert max(b - a for a, b in pairwise(removed)) == 1


def test_a_sink_with_a_definition_removes_these_categories_alone(tmp_path):
    init = source(100, lane=-2, rate=1, speed=8, mix=categories(car=1, bus=1))
    player = player_of(tmp_path, init + sink(150, radius=20, mix=categories(bus=1)))
    last = played(player)[-1]
    beyond = [pose.name for pose in traffic_of(last).values() if pose.x_m > 172.0]
    assert beyond
    assert {player.world.mover(name).entity.category for name in beyond} == {"car"}


def test_a_swarm_keeps_its_number_around_the_central_object(tmp_path):
    text = swarm("Ego", count=12, inner=30, major=150, minor=60, offset=20, velocity=10)
    player = make_player(read_scenario(written(tmp_path, scenario(init=text + begins("Ego", 300, 10), stop=30))))
    counts = []
    for frame in player.play(0.05, 30.0):
        ego = next(pose for pose in frame.poses if pose.name == "Ego")
        poses = traffic_of(frame).values()
        counts.append(len(poses))
        for pose in poses:
            far = math.hypot((pose.x_m - ego.x_m - 20.0) / 150.0, (pose.y_m - ego.y_m) / 60.0)
            assert far < 1.1  # it is looked after each half second
    assert min(counts[20:]) >= 10
    assert max(counts) == 12


def test_vehicles_of_a_swarm_appear_outside_of_the_inner_circle(tmp_path):
    text = swarm("Ego", count=12, inner=60, major=200, minor=60, velocity=10)
    player = make_player(read_scenario(written(tmp_path, scenario(init=text + begins("Ego", 300, 10), stop=20))))
    seen = set()
    for frame in player.play(0.05, 20.0):
        ego = next(pose for pose in frame.poses if pose.name == "Ego")
        for name, pose in traffic_of(frame).items():
            if name not in seen:
                seen.add(name)
                assert math.dist((pose.x_m, pose.y_m), (ego.x_m, ego.y_m)) > 58.0  # one step after it appeared
    assert len(seen) >= 12


@pytest.mark.parametrize(("same", "opposite", "lanes"), [(1, 0, {-1, -2}), (0, 3, {1})])
def test_a_swarm_has_the_directions_that_its_file_asks_for(tmp_path, same, opposite, lanes):
    text = swarm("Ego", count=6, inner=20, major=200, minor=60, speeds=(5, 9), directions=(same, opposite))
    player = make_player(read_scenario(written(tmp_path, scenario(init=text + begins("Ego", 500, 7), stop=20))))
    next(player.play())
    player.step(0.05)
    drivers = player.world.traffic.drivers.values()
    assert len(drivers) == 6
    assert {driver.mover.place.lane for driver in drivers} <= lanes
    assert all(5.0 <= driver.mover.speed_mps <= 9.0 for driver in drivers)


def test_an_area_is_filled_once(tmp_path):
    player = player_of(tmp_path, area(polygon((100, -8), (300, -8), (300, 0), (100, 0)), count=8, continuous=False))
    frames = played(player)
    assert all(100.0 <= pose.x_m <= 301.0 and pose.y_m < 0.0 for pose in traffic_of(frames[1]).values())
    assert len(traffic_of(frames[1])) == player.world.traffic.brought <= 8
    assert player.world.traffic.brought >= 5


def test_an_area_is_kept_full(tmp_path):
    roads = '<RoadRange><RoadCursor roadId="1" s="100"><Lane id="-2"/></RoadCursor><RoadCursor roadId="1" s="300"/>'
    player = player_of(tmp_path, area(f"{roads}</RoadRange>", count=4, continuous=True))
    for frame in player.play(0.05, 30.0):
        poses = traffic_of(frame).values()
        assert all(99.0 <= pose.x_m <= 310.0 and pose.y_m == pytest.approx(-5.25) for pose in poses)
    assert player.world.traffic.brought > 8
    assert len(poses) >= 3


def test_the_length_of_a_stretch_cuts_it(tmp_path):
    network = player_of(tmp_path).world.network
    stretch = RoadStretch(("1", "1"), (800.0, 100.0), (None, None), 150.0, "file:1")
    (piece,) = stretch_pieces(network, stretch)
    assert (piece.start_m, piece.end_m) == (650.0, 800.0)


def test_a_point_is_inside_a_polygon_that_is_not_convex():
    corners = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (2.0, 1.0), (0.0, 4.0)]
    assert inside_polygon(0.5, 2.0, corners)
    assert inside_polygon(3.5, 2.0, corners)
    assert not inside_polygon(2.0, 3.0, corners)


def test_traffic_is_stopped_by_its_name(tmp_path):
    later = event("end", "", at_time(10)).replace("<PrivateAction></PrivateAction>", stop("one"))
    init = source(100, lane=-1, rate=0.5, name="one") + source(100, lane=-2, rate=0.5, name="two")
    player = player_of(tmp_path, init, stories=story("Ego", later))
    frames = played(player)
    first = collections.Counter()
    seen = set()
    for frame in frames:
        for name, pose in traffic_of(frame).items():
            if name not in seen:
                seen.add(name)
                first[round(pose.y_m, 2)] += 1
    assert first[-1.75] == pytest.approx(6, abs=1)  # it has ended after ten seconds
    assert first[-5.25] == pytest.approx(16, abs=1)
    ends = [one for one in player.changes if one.path.endswith("endAction") and one.transition == "endTransition"]
    assert len(ends) == 1


def test_a_stop_without_a_name_ends_all(tmp_path):
    init = source(100, lane=-1, rate=1, speed=10, name="one") + source(100, lane=-2, rate=1, speed=10, name="")
    player = player_of(tmp_path, init + stop(""))
    played(player, longest_s=5.0)
    assert player.world.traffic.brought == 0


def test_a_definition_gives_categories_roles_and_controllers_by_their_weights(tmp_path):
    mix = categories(roles={"police": 1}, controllers=["driver"], car=3, bicycle=1)
    player = player_of(tmp_path, source(100, lane=-2, rate=4, speed=6, mix=mix) + sink(160, radius=30, lane=-2))
    found = {}
    for _ in player.play(0.05, 30.0):
        found.update({name: driver.mover for name, driver in player.world.traffic.drivers.items()})
    kinds = collections.Counter(mover.entity.category for mover in found.values())
    assert set(kinds) == {"car", "bicycle"}
    assert kinds["car"] > kinds["bicycle"] > 0
    assert all(set(mover.controllers) == {"driver"} for mover in found.values())
    blueprints = {mover.entity.category: blueprint_of(mover.entity) for mover in found.values()}
    assert blueprints == {"car": "vehicle.dodge.charger_police", "bicycle": VEHICLES["bicycle"]}


def test_a_distribution_gives_the_vehicles_of_its_templates(tmp_path):
    template = vehicle("", "vehicle.tesla.model3").replace('<ScenarioObject name="">', "<ScenarioObjectTemplate>")
    template = template.replace("</ScenarioObject>", "</ScenarioObjectTemplate>")
    mix = f"""<TrafficDistribution><TrafficDistributionEntry weight="1"><EntityDistribution>
      <EntityDistributionEntry weight="2">{template}</EntityDistributionEntry></EntityDistribution>
    </TrafficDistributionEntry></TrafficDistribution>"""
    player = player_of(tmp_path, source(100, rate=1, speed=10, mix=mix))
    played(player, longest_s=2.0)
    (first, *_) = player.world.traffic.drivers.values()
    assert blueprint_of(first.mover.entity) == "vehicle.tesla.model3"
    assert first.mover.entity.box.length_m == 4.4


def test_each_category_has_a_blueprint():
    assert set(SIZES_M) <= set(VEHICLES)


def test_the_same_seed_gives_the_same_traffic_and_another_one_other_traffic(tmp_path):
    init = swarm("Ego", count=10, inner=20, major=200, minor=60, speeds=(5, 15), mix=categories(car=1, van=1))
    one, same, other = (played(player_of(tmp_path, init, seed=seed), longest_s=10.0) for seed in (3, 3, 4))
    assert one == same
    assert one != other


def test_there_are_never_more_vehicles_than_the_bound(tmp_path, monkeypatch):
    monkeypatch.setattr("basu_openscenario.playing.traffic.MOST_VEHICLES", 9)
    player = player_of(tmp_path, source(500, rate=20, radius=450, speed=5))
    counts = [len(traffic_of(frame)) for frame in played(player, longest_s=10.0)]
    assert max(counts) == counts[-1] == 9
    assert MOST_VEHICLES == 200


def test_positions_of_traffic_name_their_file_and_line(tmp_path):
    player = player_of(tmp_path, source(100).replace('roadId="1"', 'roadId="7"'))
    with pytest.raises(ScenarioError, match=r"test\.xosc:\d+: .*has no road '7'"):
        played(player)
