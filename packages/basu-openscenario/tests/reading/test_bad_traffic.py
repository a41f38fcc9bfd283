"""What bad actions on traffic get: a sentence with file, line and what to do, before anything moves."""

import re
import time

import pytest

from basu.errors import ScenarioError
from basu_openscenario.playing.player import make_player
from basu_openscenario.reading.scenario_file import read_scenario
from openscenario_texts import begins, scenario, vehicle, written
from traffic_texts import area, categories, polygon, sink, source, stop, swarm, traffic_action

SQUARE = polygon((100, -8), (300, -8), (300, 0))


def template(inside: str) -> str:
    """Return a `TrafficDistribution` whose only entry is this template."""
    return f"""<TrafficDistribution><TrafficDistributionEntry weight="1"><EntityDistribution>
      <EntityDistributionEntry weight="1"><ScenarioObjectTemplate>{inside}</ScenarioObjectTemplate>
      </EntityDistributionEntry></EntityDistribution></TrafficDistributionEntry></TrafficDistribution>"""


def esmini_controller() -> str:
    """Return a definition with a controller of esmini."""
    own = '<Properties><Property name="esminiController" value="ControllerACC"/></Properties>'
    return categories(car=1).replace("<Properties/>", own)


WALKER = """<Pedestrian name="w" mass="80" pedestrianCategory="pedestrian">
  <BoundingBox><Center x="0" y="0" z="0.9"/><Dimensions width="0.5" length="0.5" height="1.8"/></BoundingBox>
  <Properties/></Pedestrian>"""
TRAILER = vehicle("").replace('vehicleCategory="car"', 'vehicleCategory="trailer"').split(">", 1)[1].rsplit("<", 1)[0]


@pytest.mark.parametrize(
    ("init", "sentence"),
    [
        (
            source(100, rate="1e9"),
            'rate="1e+09" of <TrafficSourceAction> is not supported; write a number from 0',
        ),
        (source(100, rate=-1), "write a number from 0 to 20 vehicles/s"),
        (source(100, rate="fast"), 'rate="fast" of <TrafficSourceAction> is no number'),
        (source(100, radius="1e9"), "write a number from 0 to 10000 m"),
        (source(100, speed="-3"), "write a number from 0 to 100 m/s"),
        (sink(100, radius="INF"), "write a number from 0 to 10000 m"),
        (sink(100, rate="1e9"), "write a number from 0 to 20 vehicles/s"),
        (swarm("Ego", count=1_000_000), "a scenario has up to 200 vehicles of traffic at a time"),
        (swarm("Ego", count=120) + area(SQUARE, count=81), "ask for 201 vehicles of traffic in all"),
        (swarm("Ego", count="2.5"), "is no whole number"),
        (swarm("Ego", major="1e9"), "write a number from 0 to 10000 m"),
        (swarm("Ego", inner=100, major=90, minor=50), "leaves no room inside the axes"),
        (swarm("Nobody"), "the entity 'Nobody' does not exist; there are Ego"),
        (swarm("Ego", speeds=(9, 5)), 'lowerLimit="9" is above upperLimit="5"; exchange them'),
        (swarm("Ego", directions=(0, 0)), "both weights of <DirectionOfTravelDistribution> are 0"),
        (swarm("Ego", directions=(-1, 2)), 'same="-1" of <DirectionOfTravelDistribution> is no weight'),
        (area(SQUARE, count=1_000_000), "a scenario has up to 200 vehicles of traffic at a time"),
        (area(""), "needs either one <Polygon> or one <RoadRange>"),
        (area(polygon((0, 0), (1, 1))), "<Polygon> has 2 positions; it needs from 3 to 1000"),
        (area('<RoadRange><RoadCursor roadId="1"/></RoadRange>'), "<RoadRange> has 1 cursors"),
        (source(100) + stop("out"), "no action on traffic is called 'out'; there are in"),
        (stop("out"), "no action on traffic is called 'out'; there are none with a name"),
        (traffic_action("<TrafficJamAction/>"), "<TrafficJamAction> is no action on traffic; use one of"),
        (source(1) * 101, "this is the 101th action on traffic; up to 100 are played"),
        (source(100, mix=categories(car=0)), "has no entry with a weight above 0; add one"),
        (source(100, mix=categories(spaceship=1)), 'category="spaceship" of <VehicleCategoryDistributionEntry>'),
        (source(100, mix=categories(trailer=1)), 'category="trailer" of <VehicleCategoryDistributionEntry>'),
        (source(100, mix=categories(roles={"king": 1}, car=1)), 'role="king" of <VehicleRoleDistributionEntry>'),
        (source(100, mix=categories(car="NaN")), 'weight="NaN" of <VehicleCategoryDistributionEntry> is no number'),
        (source(100, mix=categories(car="INF")), 'weight="inf" of <VehicleCategoryDistributionEntry> is no weight'),
        (source(100, mix=esmini_controller()), "the controller 'driver' is ControllerACC, which is esmini's own"),
        (source(100, mix=template(WALKER)), "a pedestrian does not drive by itself; let the template be a vehicle"),
        (source(100, mix=template(TRAILER)), "a trailer does not drive by itself; let the template be a vehicle"),
    ],
)
def test_bad_traffic_is_named_with_its_line_before_anything_moves(tmp_path, init, sentence):
    text = scenario(init=init + begins("Ego", 500, 10), revision=(1, 3))
    began = time.perf_counter()
    with pytest.raises(ScenarioError) as caught:
        make_player(read_scenario(written(tmp_path, text)))
    assert re.match(r"[^\n]*test\.xosc:\d+: ", str(caught.value))
    assert sentence in str(caught.value)
    assert time.perf_counter() - began < 5.0


@pytest.mark.parametrize(
    ("cursors", "sentence"),
    [
        ('<RoadCursor roadId="9"/><RoadCursor roadId="9"/>', r"test\.xosc:\d+: .*has no road '9'"),
    ],
)
def test_roads_of_an_area_that_do_not_exist_are_named_before_anything_moves(tmp_path, cursors, sentence):
    text = scenario(init=area(f"<RoadRange>{cursors}</RoadRange>") + begins("Ego", 500, 10), revision=(1, 3))
    player = make_player(read_scenario(written(tmp_path, text)))
    with pytest.raises(ScenarioError, match=sentence):
        player.step(0.0)


@pytest.mark.parametrize("revision", [(1, 0), (1, 1), (1, 2), (1, 3)])
def test_actions_on_traffic_are_read_in_all_versions(tmp_path, revision):
    init = source(100) + sink(300) + swarm("Ego", velocity=10) + stop("")
    scenario_file = read_scenario(written(tmp_path, scenario(init=init + begins("Ego", 500, 10), revision=revision)))
    assert len(scenario_file.storyboard.global_actions) == 4
