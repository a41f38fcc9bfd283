"""Claims about the example that warns others of people: it stops for a person that only the roadside sees."""

import json
from pathlib import Path
from typing import Any

import pytest

from basu.agents.builtin.cooperation.warnings import read_warning
from basu.cli import main

EXAMPLE = Path(__file__).parents[4] / "examples" / "warning_agent.py"
TICKS = 240
AHEAD_M = 20
ROADSIDE = """
import importlib.util, json

found = importlib.util.spec_from_file_location("warning_agent", EXAMPLE)
example = importlib.util.module_from_spec(found)
found.loader.exec_module(example)

class Warned(example.WarningAgent):
    def setup(self):
        super().setup()
        self.place = self.route.points_m[AHEAD_M]
        pole = carla.Transform(carla.Location(float(self.place[0]), float(self.place[1]), 8.0 + float(self.place[2])))
        blueprint = self.world.get_blueprint_library().find("sensor.other.v2x_custom")
        self.pole = self.world.spawn_actor(blueprint, pole)
        self.nearest_m = 1e9

    def run_step(self, sensor_data):
        here = self.vehicle.get_transform().location
        self.nearest_m = min(self.nearest_m, math.hypot(here.x - self.place[0], here.y - self.place[1]))
        if TEXT:
            self.pole.send(TEXT.format(x=self.place[0], y=self.place[1]))
            self.world.get_weather()
        control = super().run_step(sensor_data)
        end = [self.nearest_m, self.vehicle.get_velocity().length(), sorted(self.people.known)]
        open(FOLDER + "/end.json", "w").write(json.dumps(end))
        if self.ticks >= TICKS:
            raise ValueError("enough")
        return control

    def destroy(self):
        self.pole.destroy()
"""


def ended(folder: Path, route_file: Path, text: str) -> tuple[float, float, list[int]]:
    """How near the shuttle came to the place, its last speed in m/s, and the people that it was warned of."""
    agent = folder / "warned.py"
    names: dict[str, Any] = {"EXAMPLE": str(EXAMPLE), "FOLDER": str(folder), "TEXT": text}
    names |= {"TICKS": TICKS, "AHEAD_M": AHEAD_M}
    agent.write_text("import math\n" + "".join(f"{name} = {value!r}\n" for name, value in names.items()) + ROADSIDE)
    where = ["--agent-writes", str(folder), "--routes", str(route_file), "--output", str(folder / "runs")]
    main(["run", str(agent), "--open", *where])
    nearest_m, speed_mps, warned = json.loads((folder / "end.json").read_text())
    return nearest_m, speed_mps, warned


def test_it_stops_for_a_person_that_it_was_warned_of(tmp_path: Path, route_file: Path) -> None:
    nearest_m, speed_mps, warned = ended(tmp_path, route_file, "DENM 12 77 {x:.2f} {y:.2f} 0 0")
    assert warned == [77]
    assert speed_mps < 0.1
    assert 2.5 < nearest_m < 15.0


def test_texts_that_are_no_warnings_change_nothing(tmp_path: Path, route_file: Path) -> None:
    nearest_m, _, warned = ended(tmp_path, route_file, "DENM 12 seventy {x:.2f}")
    assert warned == []
    assert nearest_m < 2.0


@pytest.mark.parametrize(
    "text",
    ["", "hello", "DENM 12", "DENM 12 5 1 2", "DENM 97 5 1 2 3 4", "DENM 12 x 1 2 3 4", "DENM 12 5 nan 2 3 4"],
)
def test_strange_texts_are_no_warnings(text: str) -> None:
    assert read_warning(text) is None
    assert read_warning("DENM 12 5 1 2 3 4") == (5, 1.0, 2.0, 3.0, 4.0)
