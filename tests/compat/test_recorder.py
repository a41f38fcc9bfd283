"""The recorder through the official client: record, ask, replay; files stay where they belong."""

import struct
from collections.abc import Iterator
from pathlib import Path

import carla
import pytest

from fakes.own_map import TIMEOUT_S, world_of
from linden.replay.file.read import Recording
from opendrive_texts import street_through_junction
from servers import RunningServer, running_server

STEPS = 20


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("recordings")


@pytest.fixture(scope="module")
def server(folder: Path) -> Iterator[RunningServer]:
    with running_server("--log-level", "info", "--recordings", str(folder)) as running:
        yield running
        assert running.process.poll() is None, f"the server ended by itself: {running.log()}"


def spawned(world: carla.World, point: int, role: str) -> carla.Actor:
    blueprint = world.get_blueprint_library().find("vehicle.tesla.model3")
    blueprint.set_attribute("role_name", role)
    return world.spawn_actor(blueprint, world.get_map().get_spawn_points()[point])


def seen(world: carla.World, actor_ids: list[int]) -> list[bytes]:
    """Where these actors are in the last snapshot, and how they are driven, as bytes."""
    snapshot = world.get_snapshot()
    found = []
    for actor_id in actor_ids:
        pose = snapshot.find(actor_id).get_transform()
        control = world.get_actor(actor_id).get_control()
        place = (pose.location.x, pose.location.y, pose.location.z)
        turn = (pose.rotation.pitch, pose.rotation.yaw, pose.rotation.roll)
        found.append(struct.pack("<9fi", *place, *turn, control.throttle, control.steer, control.brake, control.gear))
    return found


def recorded(client: carla.Client, world: carla.World, name: str) -> tuple[list[int], list[list[bytes]]]:
    """Drive two cars and record it; returns their ids and what was seen."""
    cars = [spawned(world, 0, "hero"), spawned(world, 20, "autopilot")]
    world.tick()
    assert client.start_recorder(name, True)
    frames = []
    for n in range(STEPS):
        for number, car in enumerate(cars):
            car.apply_control(carla.VehicleControl(throttle=0.7, steer=0.1 * number))
        if n == STEPS // 2:
            cars[0].set_light_state(carla.VehicleLightState(carla.VehicleLightState.Brake))
        world.tick()
        frames.append(seen(world, [car.id for car in cars]))
    client.stop_recorder()
    return [car.id for car in cars], frames


def test_a_replay_shows_the_same_transforms_byte_for_byte(client: carla.Client, world: carla.World) -> None:
    actor_ids, frames = recorded(client, world, "same.log")
    for actor in world.get_actors(actor_ids):
        actor.destroy()
    world.tick()
    text = client.replay_file("same.log", 0.0, 0.0, actor_ids[0])
    assert (
        "Total time recorded: 0.95\nReplaying from 0 s - 0.95 s (0.95 s) at 1.0x\nIgnoring Spectator camera\n" in text
    )
    again = []
    for _ in range(STEPS):
        world.tick()
        again.append(seen(world, actor_ids))
    assert again == frames
    assert world.get_actor(actor_ids[0]).get_light_state() == carla.VehicleLightState.Brake
    hero, spectator = world.get_actor(actor_ids[0]).get_transform(), world.get_spectator().get_transform()
    assert spectator.location.distance(hero.location) == pytest.approx(11.18, abs=0.05)  # (-10, 0, 5) from the hero


def test_a_replay_on_another_map_loads_it_first(
    server: RunningServer, client: carla.Client, world: carla.World, folder: Path
) -> None:
    actor_ids, _ = recorded(client, world, "there.log")
    here = world.get_map().name
    del client, world
    assert world_of(server.port, street_through_junction()).get_map().name != here
    client = carla.Client("127.0.0.1", server.port)  # one that listens to nothing yet
    client.set_timeout(TIMEOUT_S)
    text = client.replay_file(str(folder / "there.log"), 0.0, 0.0, 0)
    assert "Loading map Linden\nReplayer will start after map is loaded...\n" in text
    world = client.get_world()
    assert world.get_map().name == here
    assert sorted(actor.id for actor in world.get_actors().filter("vehicle.*")) == actor_ids
    client.stop_replayer(True)


def test_reports_tell_what_happened(client: carla.Client, world: carla.World) -> None:
    actor_ids, _ = recorded(client, world, "told.log")
    text = client.show_recorder_file_info("told.log", False)
    assert text.startswith("Version: 1\nMap: Linden\nDate: ")
    assert f" Create {actor_ids[0]}: vehicle.tesla.model3 (1) at (" in text
    assert "  role_name = hero\n" in text
    assert text.endswith(f"\nFrames: {STEPS}\nDuration: 0.95 seconds\n")
    assert " Positions: " in client.show_recorder_file_info("told.log", True)
    assert "vehicle" not in client.show_recorder_collisions("told.log", "h", "v").partition("Actor 2")[2]
    assert " vehicle.tesla.model3 " not in client.show_recorder_actors_blocked("told.log", 0.5, 1.0)
    with pytest.raises(RuntimeError, match="no such kinds of actors; the kinds are 'h' hero, 'v' vehicles"):
        client.show_recorder_collisions("told.log", "x", "v")


def test_a_missing_recording_is_refused_in_carlas_words(client: carla.Client, folder: Path) -> None:
    (folder / "notes.txt").write_text("no recording at all")
    missing = f"File {folder / 'missing.log'} not found on server\n"
    assert client.show_recorder_file_info("missing.log", False) == missing
    assert client.show_recorder_collisions("missing.log", "a", "a") == missing
    assert client.show_recorder_actors_blocked("missing.log", 1, 1) == missing
    assert client.replay_file("missing.log", 0, 0, 0) == f"Replaying File: {folder / 'missing.log'}\n{missing}"
    assert client.show_recorder_collisions("notes.txt", "a", "a") == "File is not a CARLA recorder\n"


def test_a_damaged_recording_is_refused_with_the_byte(client: carla.Client, world: carla.World, folder: Path) -> None:
    recorded(client, world, "damaged.log")
    content = bytearray((folder / "damaged.log").read_bytes())
    behind_the_first_start = 34 + 29  # bytes of the header, and of a frame's start
    content[behind_the_first_start] = 0  # a frame's start again
    (folder / "damaged.log").write_bytes(content)
    for ask in (
        lambda: client.show_recorder_file_info("damaged.log", True),
        lambda: client.replay_file("damaged.log", 0, 0, 0),
    ):
        with pytest.raises(RuntimeError, match=r"damaged recording: at byte \d+"):
            ask()


def test_files_outside_of_the_folder_are_refused(client: carla.Client, folder: Path) -> None:
    for name in ("/etc/drive.log", "../drive.log", str(folder.parent / "drive.log")):
        with pytest.raises(RuntimeError, match="start the server with --recordings DIR"):
            client.start_recorder(name)
        with pytest.raises(RuntimeError, match="lies outside of"):
            client.show_recorder_file_info(name, False)
    assert client.start_recorder(str(folder / "runs" / "today.log")) == str(folder / "runs" / "today.log")
    client.stop_recorder()


def test_what_cannot_be_written_is_refused_and_the_simulation_goes_on(
    client: carla.Client, world: carla.World, folder: Path
) -> None:
    (folder / "taken.log").mkdir()
    (folder / "file").write_text("")
    for name, why in (("taken.log", "Is a directory"), ("file/drive.log", "Not a directory|File exists")):
        with pytest.raises(RuntimeError, match=f"cannot be written: ({why})"):
            client.start_recorder(name)
    frame = world.tick()
    assert world.tick() == frame + 1


def test_a_killed_server_leaves_every_whole_frame(tmp_path: Path) -> None:
    with running_server("--sync", "--recordings", str(tmp_path)) as running:
        client = carla.Client("127.0.0.1", running.port)
        client.set_timeout(20.0)
        world = client.get_world()
        client.start_recorder("killed.log", True)
        for _ in range(7):
            world.tick()
        running.process.kill()
        running.process.wait()
    with Recording(tmp_path / "killed.log") as recording:
        assert [frame.number for frame in recording.whole_frames()] == list(range(1, 8))
