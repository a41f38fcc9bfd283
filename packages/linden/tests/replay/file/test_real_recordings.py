"""Recordings of the real CARLA, which nobody here may pass on: LINDEN_RECORDINGS names the folder that has them.

They are the examples of ScenarioRunner's metrics (srunner/metrics/data); the figures are counted by another reader.
"""

import os
from collections import Counter
from pathlib import Path
from typing import NamedTuple

import pytest

from linden.replay.file.layouts import PacketId
from linden.replay.file.read import Recording

FOLDER = os.environ.get("LINDEN_RECORDINGS", "")
pytestmark = pytest.mark.skipif(
    not FOLDER, reason="LINDEN_RECORDINGS names no folder with recordings of the real CARLA"
)


class Counted(NamedTuple):
    file: str
    frames: int
    duration_s: float
    actors: int
    positions: int
    vehicles: dict[str, str]


COUNTED = (
    Counted(
        "DistanceBetweenVehicles.log", 847, 24.72, 181, 99_939,
        {"vehicle.lincoln.mkz_2017": "hero", "vehicle.nissan.patrol": "scenario"},
    ),
    Counted("DistanceToLaneCenter.log", 432, 12.53, 183, 51_836, {"vehicle.lincoln.mkz_2017": "hero"}),
)  # fmt: skip


@pytest.mark.parametrize("counted", COUNTED, ids=lambda counted: counted.file)
def test_it_parses_to_the_end_with_everything_in_it(counted: Counted) -> None:
    with Recording(Path(FOLDER) / counted.file) as recording:
        assert (recording.header.version, recording.header.map_name) == (1, "Town01")
        frames = list(recording.frames())
    actors = [actor for frame in frames for actor in frame.added]
    assert [frame.number for frame in frames] == list(range(1, counted.frames + 1))
    assert frames[-1].elapsed_s == pytest.approx(counted.duration_s, abs=0.01)
    assert len(actors) == counted.actors
    assert {
        actor.description.id: actor.description.attribute("role_name") for actor in actors if actor.kind == 1
    } == counted.vehicles
    kinds = Counter(actor.description.id.split(".")[0] for actor in actors)
    assert (kinds["spectator"], kinds["sensor"], kinds["traffic"]) == (1, 6, 57)
    assert sum(len(frame.positions) for frame in frames) == counted.positions
    assert sum(len(frame.physics) for frame in frames) == len(counted.vehicles)
    assert sum(len(frame.collisions) + len(frame.walkers) for frame in frames) == 0
    assert all(PacketId.VISUAL_TIME not in frame.packets for frame in frames)
    (times,) = (frame.light_times for frame in frames if len(frame.light_times))
    assert {tuple(row) for row in times[["green_s", "yellow_s", "red_s"]].tolist()} == {(10.0, 3.0, 2.0)}
    assert len(times) == 36
