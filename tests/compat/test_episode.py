"""Claims about episodes, maps and settings, as the official client sees them."""

import math
from pathlib import Path

import carla
import pytest

from opendrive_texts import PLAIN_ROAD
from servers import running_server


def test_the_home_map_is_offered_and_loaded(client: carla.Client) -> None:
    assert "/Game/Carla/Maps/Linden" in client.get_available_maps()
    assert client.get_world().get_map().name == "Carla/Maps/Linden"


def test_every_name_of_a_map_loads_it(client: carla.Client) -> None:
    for name in ("Linden", "/Game/Carla/Maps/Linden", "Carla/Maps/Linden"):
        assert client.load_world(name).get_map().name == "Carla/Maps/Linden"


def test_the_map_of_the_thesis_has_stop_signs_in_place_of_lights(client: carla.Client) -> None:
    usual = client.get_world().get_actors()
    client.set_timeout(120.0)  # the first load derives what a cache holds afterwards
    world = client.load_world("Linden_thesis")
    assert world.get_map().name == "Carla/Maps/Linden_thesis"
    actors = world.get_actors()
    lights = len(usual.filter("traffic.traffic_light"))
    assert (lights, len(actors.filter("traffic.traffic_light"))) == (22, 0)
    assert len(actors.filter("traffic.stop")) == len(usual.filter("traffic.stop")) + lights
    named = {thing.name for thing in world.get_environment_objects(carla.CityObjectLabel.Buildings)}
    assert any("LindenTransitCenter" in name for name in named)
    client.load_world("Linden")


def test_a_map_that_is_not_there_is_refused_in_carlas_words(client: carla.Client) -> None:
    with pytest.raises(RuntimeError, match="Map 'Town99' not found"):
        client.load_world("Town99")
    assert client.get_world().get_map().name == "Carla/Maps/Linden"


def test_a_reload_begins_an_episode_without_the_spawned_actors(client: carla.Client, world: carla.World) -> None:
    blueprint = world.get_blueprint_library().filter("vehicle.*")[0]
    world.spawn_actor(blueprint, world.get_map().get_spawn_points()[0])
    frame = world.tick()
    fresh = client.reload_world()
    assert fresh.id != world.id
    assert not fresh.get_actors().filter("vehicle.*")
    assert not fresh.get_settings().synchronous_mode
    assert fresh.get_snapshot().frame >= frame


def test_a_reload_may_keep_the_settings(client: carla.Client, world: carla.World) -> None:
    assert world.get_settings().synchronous_mode
    kept = client.reload_world(False).get_settings()
    assert kept.synchronous_mode
    assert kept.fixed_delta_seconds == 0.05


def test_a_world_is_made_of_an_opendrive_text(client: carla.Client) -> None:
    world = client.generate_opendrive_world(PLAIN_ROAD)
    assert world.get_map().name == "Carla/Maps/OpenDriveMap"
    waypoint = world.get_map().get_waypoint(carla.Location(100.0, 1.75, 0.0))
    assert waypoint.lane_id == -1
    assert world.get_map().to_opendrive() == PLAIN_ROAD


def test_a_text_that_is_no_map_is_refused_and_the_world_stays(client: carla.Client) -> None:
    episode = client.get_world().id
    with pytest.raises(RuntimeError, match="OpenDRIVE"):
        client.generate_opendrive_world("<OpenDRIVE><road></OpenDRIVE>")
    assert client.get_world().id == episode


def test_maps_of_a_folder_are_offered_under_their_names(tmp_path: Path) -> None:
    (tmp_path / "Plain.xodr").write_text(PLAIN_ROAD, "utf-8")
    with running_server("--maps", str(tmp_path), "--map", "Plain") as server:
        client = carla.Client("127.0.0.1", server.port)
        client.set_timeout(20.0)
        names = ("Linden", "Linden_thesis", "Plain")
        assert client.get_available_maps() == [f"/Game/Carla/Maps/{name}" for name in names]
        assert client.get_world().get_map().name == "Carla/Maps/Plain"
        assert client.load_world("Linden").get_map().name == "Carla/Maps/Linden"


def test_settings_come_back_as_they_were_set(client: carla.Client) -> None:
    world = client.get_world()
    wanted = carla.WorldSettings(
        synchronous_mode=True,
        no_rendering_mode=True,
        fixed_delta_seconds=0.025,
        substepping=False,
        max_substep_delta_time=0.005,
        max_substeps=4,
        max_culling_distance=100.0,
        deterministic_ragdolls=False,
        tile_stream_distance=1000.0,
        actor_active_distance=500.0,
    )
    world.apply_settings(wanted)
    assert world.get_settings() == wanted


@pytest.mark.parametrize("step_s", [0.01, 0.05, 0.1, 1.0 / 30.0])
def test_the_step_is_reported_exactly_from_the_next_frame_on(client: carla.Client, step_s: float) -> None:
    world = client.get_world()
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, step_s
    before = world.apply_settings(settings)
    after = world.tick()
    assert after - before <= 3  # else the client has been ticking on in search of the step it set
    assert world.get_snapshot().timestamp.delta_seconds == pytest.approx(step_s, rel=1e-7)


def test_elapsed_time_is_the_sum_of_the_steps(world: carla.World) -> None:
    world.tick()
    start = world.get_snapshot().timestamp
    for _ in range(20):
        world.tick()
    end = world.get_snapshot().timestamp
    assert end.frame - start.frame == 20
    assert math.isclose(end.elapsed_seconds - start.elapsed_seconds, 1.0, abs_tol=1e-6)


@pytest.mark.parametrize(
    ("name", "value", "sentence"),
    [
        ("fixed_delta_seconds", 3600.0, "fixed_delta_seconds must be above 0 and at most 10 s, not 3600"),
        ("max_substeps", 0, "substepping needs max_substep_delta_time above 0 and max_substeps of at least 1"),
        ("max_substep_delta_time", 0.0, "substepping needs"),
    ],
)
def test_settings_by_which_time_cannot_pass_are_refused(
    world: carla.World, name: str, value: float, sentence: str
) -> None:
    settings = world.get_settings()
    setattr(settings, name, value)
    with pytest.raises(RuntimeError, match=sentence):
        world.apply_settings(settings)
    assert world.get_settings().fixed_delta_seconds == 0.05


def test_frames_come_by_themselves_in_asynchronous_mode(client: carla.Client) -> None:
    world = client.get_world()
    first = world.wait_for_tick(10.0)
    second = world.wait_for_tick(10.0)
    assert second.frame > first.frame
    assert 0.0 < second.timestamp.delta_seconds <= 0.1


def test_leaving_synchronous_mode_lets_time_pass_again(world: carla.World) -> None:
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = False, None
    frame = world.apply_settings(settings)
    assert world.wait_for_tick(10.0).frame > frame


def test_frames_grow_across_episodes(client: carla.Client, world: carla.World) -> None:
    frame = world.tick()
    assert client.reload_world().wait_for_tick(10.0).frame > frame
