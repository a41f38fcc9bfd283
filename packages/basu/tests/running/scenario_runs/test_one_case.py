"""Claims about the ego's way: as the case gives it, else straight on to behind the next junction."""

import math
from pathlib import Path

import carla
import pytest

from basu.episode.spec import description_of
from basu.scenarios.cases import cases_of
from basu.scenarios.playable import Playable
from basu.scenarios.stage import Pose
from basu.scenarios.xml_elements import Case, GivenActor
from fakes.crossing_map import crossing

ROOT = Path(__file__).parents[5]


@pytest.fixture(name="town", scope="module")
def town_() -> carla.Map:
    return carla.Map("Crossing", crossing())


def westward(*way: Pose, needs_m: float = 20.0, needs_junction: bool = True) -> Playable:
    """From the east arm of the little crossing."""
    (example,) = cases_of(str(ROOT / "examples" / "scenarios" / "bin_lorry.xml"))
    ego = GivenActor(role="hero", model="vehicle.*", pose=Pose(60.0, -1.75, 0.0, math.pi))
    needing = type("Needing", (example.scenario,), {"needs_m": needs_m, "needs_junction": needs_junction})
    return Playable(Case(name="a", type="Needing", town="Crossing", ego=ego, way=way), needing, {})


def test_the_points_of_a_case_are_its_way(town: carla.Map) -> None:
    points = description_of(westward(Pose(20.0, -1.75), Pose(-40.0, -1.75)), town).points
    assert [(point.x_m, point.y_m) for point in points] == [(60.0, -1.75), (20.0, -1.75), (-40.0, -1.75)]


def test_without_a_destination_it_goes_straight_on_as_far_as_the_scenario_needs(town: carla.Map) -> None:
    last = description_of(westward(needs_junction=False), town).points[-1]
    assert (last.x_m, last.y_m) == (pytest.approx(40.0, abs=1.0), pytest.approx(-1.75, abs=0.1))


def test_where_a_junction_is_needed_it_goes_to_30_m_behind_the_junction(town: carla.Map) -> None:
    last = description_of(westward(), town).points[-1]
    left = next(x for x in range(0, -60, -1) if not town.get_waypoint(carla.Location(x=float(x), y=-1.75)).is_junction)
    assert last.x_m == pytest.approx(left - 30.0, abs=2.0)
    assert last.y_m == pytest.approx(-1.75, abs=0.1)


def test_it_goes_to_the_junction_and_as_far_as_the_scenario_needs_where_that_is_farther(town: carla.Map) -> None:
    assert description_of(westward(needs_m=115.0), town).points[-1].x_m == pytest.approx(-55.0, abs=2.0)
