"""Claims about an agent's radios: what it hears and when, and what it says."""

import json
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from basu.cli import main

AGENT = """
import json

class Talking(AutonomousAgent):
    def sensors(self):
        return [
            {"type": "sensor.other.v2x", "id": "CAM", "use_etsi_fading": "true"},
            {"type": "sensor.other.v2x_custom", "id": "TEXT"},
            {"type": "sensor.other.v2x_custom", "id": "SELDOM", "sensor_tick": 0.25},
        ]

    def setup(self):
        self.steps, self.roadside, self.answers = [], None, []
        if OPEN:
            library, place = self.world.get_blueprint_library(), self.vehicle.get_transform()
            place.location.z += 8.0
            self.cam, self.roadside = (
                self.world.spawn_actor(library.find(name), place)
                for name in ("sensor.other.v2x", "sensor.other.v2x_custom")
            )
            self.roadside.listen(lambda event: self.answers.extend(m.get()["Message"]["Message"] for m in event))

    def run_step(self, sensor_data):
        now = self.world.get_snapshot().frame
        heard = {name: (now - frame, [m.get() for m in event]) for name, (frame, event) in sensor_data.items()}
        self.steps.append(heard)
        if self.roadside is not None:
            self.roadside.send(f"step {len(self.steps)}")
            self.world.get_weather()
        self.send("TEXT", f"answer {len(self.steps)}")
        if len(self.steps) == 45:
            wrong = []
            for name, text in (("CAM", "a"), ("NONE", "a"), ("TEXT", "x" * 100)):
                try:
                    self.send(name, text)
                except ValueError as error:
                    wrong.append(str(error))
            open(FOLDER + "/steps.json", "w").write(json.dumps([self.steps, self.answers, wrong]))
            raise ValueError("enough")
        return carla.VehicleControl(brake=1.0)

    def config(self):
        return {"vehicle": "vehicle.tesla.model3"}

    def destroy(self):
        if self.roadside is not None:
            self.roadside.destroy()
            self.cam.destroy()
"""


class Drive(NamedTuple):
    """What the agent heard by step, what the roadside heard, what could not be sent, and the result."""

    steps: list[Any]
    answers: list[str]
    wrong: list[str]
    result: dict[str, Any]


def drive(folder: Path, route_file: Path, *options: str) -> Drive:
    """A run with a server of its own."""
    folder.mkdir()
    agent = folder / "talking.py"
    agent.write_text(f"OPEN = {'--open' in options}\nFOLDER = {str(folder)!r}\n" + AGENT)
    where = ["--agent-writes", str(folder), "--routes", str(route_file), "--output", str(folder / "runs")]
    main(["run", str(agent), *where, *options])
    result = json.loads((folder / "runs" / "latest" / "result.json").read_text())
    return Drive(*json.loads((folder / "steps.json").read_text()), result)


def test_texts_and_messages_arrive_in_the_next_step_and_a_second_run_is_the_same(
    tmp_path: Path, route_file: Path
) -> None:
    steps, answers, _, _ = drive(tmp_path / "first", route_file, "--open")
    assert all(late == 0 for step in steps for name, (late, _) in step.items() if name != "SELDOM")
    texts = [[message["Message"]["Message"] for message in step["TEXT"][1]] for step in steps]
    assert texts == [[], *([f"step {number}"] for number in range(1, 45))]
    assert answers[:40] == [f"answer {number}" for number in range(1, 41)]
    seldom = [messages for late, messages in (step["SELDOM"] for step in steps) if late == 0]
    assert 8 <= len(seldom) <= 10
    assert all(len(messages) == 5 for messages in seldom[1:])
    told = [number for number, step in enumerate(steps) if step["CAM"][1]]
    assert len(told) in (2, 3)
    assert {later - earlier for earlier, later in pairwise(told)} == {20}  # a road side unit's second
    again = drive(tmp_path / "second", route_file, "--open").steps
    assert [step["CAM"][1] for step in again] == [step["CAM"][1] for step in steps]


@pytest.mark.parametrize("track", ["objects", "sensors"])
def test_behind_the_gate_an_agent_may_listen_and_send_in_every_track(
    track: str, tmp_path: Path, route_file: Path
) -> None:
    steps, answers, wrong, result = drive(tmp_path / "gated", route_file, "--track", track)
    assert all(step["CAM"] == [0, []] and step["TEXT"] == [0, []] for step in steps)
    assert "enough" in result["message"]
    assert result["meta"]["access"]["refused"] == {}
    assert (answers, len(wrong)) == ([], 3)
    assert "no sensor.other.v2x_custom with the id 'CAM'" in wrong[0]
    assert "at most 99" in wrong[2]
