"""Claims about what a world sends to its pages."""

import numpy as np
import pytest

from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.debug_shapes import DebugShape, Point
from linden.protocol.values.episode import CLEAR_NOON
from linden.protocol.values.space import Vector3D
from linden.world import World
from linden_window.observer import MOST_SHAPES, WorldObserver
from linden_window.poses import HEADER, JUMPS, MAGIC, POSE

CAR = ActorDescription(0, "vehicle.tesla.model3")
RED = DebugShape(Point(Vector3D(1.0, 2.0, 3.0), 0.1), (255, 0, 0), 0.2, persistent_lines=False)


def rows(message: bytes) -> np.ndarray:
    magic, _, _, count, _ = HEADER.unpack_from(message)
    assert magic == MAGIC
    found = np.frombuffer(message, POSE, offset=HEADER.size)
    assert len(found) == count
    return found


def test_without_a_page_no_frame_is_packed(world: World, recorder) -> None:
    observer = WorldObserver(world, recorder)
    world.step(0.05)
    observer.after_frame()
    assert recorder.frames == []
    assert [note["type"] for note in recorder.notes] == ["map"]


def test_a_new_page_gets_the_present_state_at_once(world: World, recorder) -> None:
    car = world.spawn(CAR, world.spawn_points[0])
    world.step(0.05)
    observer = WorldObserver(world, recorder)
    observer.has_pages(1)
    assert {"map", "actors", "weather", "lights", "lamps", "settings", "debug"} == {n["type"] for n in recorder.notes}
    assert car.id in {row["id"] for row in rows(recorder.frames[-1])}


def test_poses_are_those_of_the_snapshot(world: World, recorder) -> None:
    car = world.spawn(CAR, world.spawn_points[0])
    observer = WorldObserver(world, recorder)
    observer.has_pages(1)
    for _ in range(40):
        world.step(0.05)
        observer.after_frame()
    found = rows(recorder.frames[-1])
    row = found[found["id"] == car.id][0]
    x, y, z, pitch, yaw, roll = world.episode.actors.pose[world.episode.actors.row(car.id)]
    assert row["place"] == pytest.approx((x, y, z), abs=1e-3)
    wanted = np.array([pitch, yaw, roll])
    turned = row["rotation"] * 180.0 / 32767.0
    assert np.abs((turned - wanted + 180.0) % 360.0 - 180.0).max() < 0.01


def test_facts_are_sent_when_they_change_and_not_before(world: World, recorder) -> None:
    observer = WorldObserver(world, recorder)
    observer.has_pages(1)
    world.step(0.05)
    observer.after_frame()
    assert len(recorder.of("weather")) == 1
    world.episode.weather = CLEAR_NOON._replace(precipitation=50.0)
    observer.after_frame()
    assert [note["weather"]["precipitation"] for note in recorder.of("weather")] == [0.0, 50.0]


def test_the_page_learns_of_an_actor_that_comes_or_goes(world: World, recorder) -> None:
    observer = WorldObserver(world, recorder)
    observer.has_pages(1)
    car = world.spawn(CAR, world.spawn_points[0])
    observer.after_frame()
    world.destroy(car.id)
    world.step(0.05)
    observer.after_frame()
    there = [car.id in {actor["id"] for actor in note["actors"]} for note in recorder.of("actors")]
    assert (there[0], any(there), there[-1]) == (False, True, False)


def test_a_new_episode_begins_with_a_jump(world: World, recorder) -> None:
    observer = WorldObserver(world, recorder)
    observer.has_pages(1)
    world.load(world.episode.map, reset_settings=False)
    observer.after_frame()
    assert len(recorder.of("map")) == 2
    assert HEADER.unpack_from(recorder.frames[-1])[4] == JUMPS


def test_shapes_are_sent_once_and_a_clearing_sends_what_is_left(world: World, recorder) -> None:
    observer = WorldObserver(world, recorder)
    observer.has_pages(1)
    debug = world.episode.surroundings.debug
    debug.draw(RED, 0.0)
    observer.after_frame()
    observer.after_frame()
    sent = [shape for note in recorder.of("debug") for shape in note["shapes"]]
    assert [(s["form"], s["at"], s["colour"], s["until"]) for s in sent] == [
        ("point", [1.0, 2.0, 3.0], [255, 0, 0], 0.2)
    ]
    debug.clear_shapes()
    observer.after_frame()
    assert (recorder.of("debug")[-1]["reset"], recorder.of("debug")[-1]["shapes"]) == (True, [])


def test_a_flood_of_shapes_is_cut_and_counted(world: World, recorder) -> None:
    observer = WorldObserver(world, recorder)
    observer.has_pages(1)
    for _ in range(MOST_SHAPES + 7):
        world.episode.surroundings.debug.draw(RED, 0.0)
    observer.after_frame()
    note = recorder.of("debug")[-1]
    assert (len(note["shapes"]), note["dropped"]) == (MOST_SHAPES, 7)
