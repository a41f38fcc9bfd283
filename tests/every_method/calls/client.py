"""carla.Client: connections, maps, batches, files, the recorder."""

import time
from typing import Any

import carla

from every_method.call import Call
from every_method.stage import TIMEOUT_S, Stage
from opendrive_texts import street_through_junction


def another(stage: Stage) -> carla.Client:
    """A client of its own, on the same wiretap."""
    client = carla.Client("127.0.0.1", stage.tap.port())
    client.set_timeout(TIMEOUT_S)
    return client


def traffic_manager(stage: Stage) -> bool:
    """Whether a Traffic Manager begins; it ends at once, for its thread would go round all the time."""
    stage.forget(
        "get_actors_by_id", "get_episode_settings", "get_vehicle_light_states", "get_weather_parameters", "apply_batch"
    )
    manager = stage.client.get_trafficmanager(8010)
    port = manager.get_port()
    with stage.aside():
        manager.shut_down()
    return port == 8010


def recorded(stage: Stage) -> str:
    """Record a second of a parked car; return the name of the log."""

    def make() -> str:
        assert stage.vehicle.is_alive
        path = stage.client.start_recorder("every_method.log", True)
        stage.tick(20)
        stage.client.stop_recorder()
        stage.tick(1)
        assert "every_method.log" in path, path
        return "every_method.log"

    return str(stage.once("recording", make))


def in_no_time(stage: Stage) -> bool:
    """Whether a client gives up after the time it is told: nobody answers on a port that is closed."""
    client = carla.Client("127.0.0.1", 9)
    client.set_timeout(0.1)
    began_s = time.monotonic()
    try:
        client.get_server_version()
    except RuntimeError as error:
        return "time-out" in str(error) and time.monotonic() - began_s < 5.0
    return False


def moved_by_batch(stage: Stage, *, answered: bool) -> bool | None:
    """Whether a command of a batch is carried out."""
    spectator = stage.world.get_spectator()
    command = carla.command.ApplyTransform(spectator, carla.Transform(carla.Location(z=40.0)))
    if not answered:
        stage.client.apply_batch([command])
        return None
    (response,) = stage.client.apply_batch_sync([command])
    return not response.has_error()


def replayed(stage: Stage) -> bool:
    """Whether a recording is played."""
    text = stage.client.replay_file(recorded(stage), 0.0, 0.0, 0)
    stage.tick(2)
    return "Total time recorded" in text


def loaded(world: carla.World) -> bool:
    """Whether a world is there, on the map that was asked for."""
    return str(world.get_map().name).endswith("Linden")


def generated(stage: Stage) -> bool:
    """Whether a world is made of a text."""
    world = another(stage).generate_opendrive_world(street_through_junction())
    return str(world.get_map().name).endswith("OpenDriveMap")


def base_folder(stage: Stage) -> Any:
    """Set where files from the server are kept."""
    return another(stage).set_files_base_folder(str(stage.folder))


CALLS: dict[str, Call] = {
    "Client.__init__": lambda s: isinstance(another(s), carla.Client),
    "Client.set_timeout": in_no_time,
    "Client.get_client_version": lambda s: s.client.get_client_version() == "0.9.16",
    "Client.get_server_version": lambda s: another(s).get_server_version() == "0.9.16",
    "Client.get_world": lambda s: another(s).get_world().id == s.world.id,
    "Client.get_available_maps": lambda s: any(name.endswith("Linden") for name in s.client.get_available_maps()),
    "Client.get_required_files": lambda s: isinstance(s.client.get_required_files("", False), list),
    "Client.request_file": lambda s: s.client.request_file(s.client.get_required_files("Nav", False)[0]),
    "Client.set_files_base_folder": base_folder,
    "Client.apply_batch": lambda s: moved_by_batch(s, answered=False),
    "Client.apply_batch_sync": lambda s: moved_by_batch(s, answered=True),
    "Client.get_trafficmanager": traffic_manager,
    "Client.start_recorder": lambda s: s.client.start_recorder("every_method_begun.log").endswith("begun.log"),
    "Client.stop_recorder": lambda s: s.client.stop_recorder(),
    "Client.show_recorder_file_info": lambda s: "Frames: " in s.client.show_recorder_file_info(recorded(s), False),
    "Client.show_recorder_collisions": lambda s: (
        "Duration: " in s.client.show_recorder_collisions(recorded(s), "a", "a")
    ),
    "Client.show_recorder_actors_blocked": lambda s: (
        "Duration: " in s.client.show_recorder_actors_blocked(recorded(s), 0.1, 10.0)
    ),
    "Client.set_replayer_time_factor": lambda s: s.client.set_replayer_time_factor(1.0),
    "Client.set_replayer_ignore_hero": lambda s: s.client.set_replayer_ignore_hero(False),
    "Client.set_replayer_ignore_spectator": lambda s: s.client.set_replayer_ignore_spectator(True),
    "Client.replay_file": replayed,
    "Client.stop_replayer": lambda s: s.client.stop_replayer(True),
    "Client.reload_world": lambda s: loaded(another(s).reload_world()),
    "Client.load_world": lambda s: loaded(another(s).load_world("Linden")),
    "Client.load_world_if_different": lambda s: another(s).load_world_if_different("Linden"),
    "Client.generate_opendrive_world": generated,
}
