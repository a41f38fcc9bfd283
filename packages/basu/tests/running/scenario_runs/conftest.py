"""A scenario of a user's, short and quiet, with cases that go well and cases that go wrong."""

from pathlib import Path

import pytest

CLASSES = '''
"""What a user may write."""

from basu.scenarios.actions import Action, Wait, WalkAlong
from basu.scenarios.criteria import Arrives, LeastDistance, NoCollision
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Number
from basu.scenarios.paths import Path
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import EgoNear, EgoPasses


class Crosser(Scenario):
    """A pedestrian crosses the street."""

    group = Group.PEDESTRIAN
    parameters = (Number("ahead", 28.0, 5.0, 200.0, "m", "where"), Number("right", 4.0, -60.0, 60.0, "m", "where"))
    needs_m = 45.0
    timeout_s = 30.0

    def start(self):
        return self.place.at(self.number("ahead"), self.number("right"), -90.0)

    def actors(self):
        return [ActorSpec("walker", "walker.pedestrian.0001", self.start())]

    def trigger(self):
        return EgoNear("walker", 22.0)

    def conflict(self):
        return WalkAlong("walker", Path.straight(self.start(), 9.0), 1.6)

    def criteria(self):
        return [NoCollision(), LeastDistance(0.3), Arrives()]


class Stumbles(Crosser):
    """An action that raises."""

    class Stumble(Action):
        def act(self):
            raise ZeroDivisionError("stumbled")

    def conflict(self):
        return self.Stumble("stumble")


class Dozes(Crosser):
    """A trigger that never comes true."""

    def trigger(self):
        return EgoPasses(1000.0)


class Leads(Crosser):
    """Leads an actor that is not there."""

    def conflict(self):
        return WalkAlong("absent", Path.straight(self.start(), 9.0), 1.6)
'''
AT = '<ego_vehicle x="223.3" y="114.7" z="0.5" yaw="3.2" model="vehicle.easymile.ez10"/>'


def case(name: str, scenario: str = "Crosser", inside: str = "", town: str = "Linden") -> str:
    return f'<scenario name="{name}" type="{scenario}" town="{town}">{AT}{inside}</scenario>'


CASES = [
    case("goes_well"),
    case("stumbles", "Stumbles"),
    case("dozes", "Dozes"),
    case("leads", "Leads"),
    case("elsewhere", town="Town05"),
    case("indoors", inside='<ahead value="73.5"/><right value="17.5"/>'),
]


@pytest.fixture
def files(tmp_path: Path) -> Path:
    """The XML file; its classes lie beside it."""
    (tmp_path / "mine.py").write_text(CLASSES, encoding="utf-8")
    path = tmp_path / "mine.xml"
    path.write_text("<scenarios>\n" + "\n".join(CASES) + "\n</scenarios>\n", encoding="utf-8")
    return path
