"""Claims about when a frame waits for what sensors look at."""

from types import SimpleNamespace

import pytest

from fakes.simulation import FakeFrames, FakeMaps, FakeSensorScene
from linden.sensors.runtime.measure import EpisodeSensors
from linden.server.rpc.context import Context

CAMERA, STREAM = 7, 3


@pytest.mark.parametrize(
    ("is_there", "listened", "waits"), [(False, {STREAM}, True), (False, {1}, False), (True, {STREAM}, False)]
)
def test_a_frame_waits_for_the_scene_only_where_a_sensor_looks_at_it(
    *, is_there: bool, listened: set[int], waits: bool
) -> None:
    episode = SimpleNamespace(actors={CAMERA: SimpleNamespace(stream_id=STREAM)})
    sensors = EpisodeSensors()
    sensors.looking[CAMERA] = None
    context = Context(
        world=SimpleNamespace(sensor_scene=FakeSensorScene(is_there=is_there), episode=episode, sensors=sensors),
        maps=FakeMaps(),
        frames=FakeFrames(),
        streams=SimpleNamespace(listened=lambda: listened),
        variable_step_s=lambda: 0.1,
    )
    assert context.waits_for_the_scene() is waits
    assert context.builds_the_scene() is not is_there
