"""carla.World, its snapshots, debug shapes and the objects of its scene."""

import threading
from typing import Any

import carla

from every_method.call import Call
from every_method.calls.geometry import floats
from every_method.calls.map import stop_sign
from every_method.entries import fields
from every_method.stage import Stage

RED = carla.Color(255, 0, 0)
UP = carla.Vector3D(z=1.0)


def above(stage: Stage) -> carla.Location:
    """A place above the road, where nobody stands."""
    return stage.waypoint.next(15.0)[0].transform.location + carla.Location(z=5.0)


def below(stage: Stage) -> carla.Location:
    """The place under the road below it."""
    return above(stage) - carla.Location(z=10.0)


def waited(stage: Stage) -> bool:
    """Whether somebody who waits for a frame is woken by it."""
    frames: list[int] = []
    waiter = threading.Thread(target=lambda: frames.append(stage.world.wait_for_tick(10.0).frame))
    waiter.start()
    while waiter.is_alive():
        stage.tick(1)
    return len(frames) == 1


def told(stage: Stage) -> bool:
    """Whether a callback hears of a frame, and of none once it is taken away."""
    frames: list[int] = []
    number = stage.world.on_tick(lambda snapshot: frames.append(snapshot.frame))
    stage.tick(2)
    stage.world.remove_on_tick(number)
    return len(frames) >= 1


def kept_weather(stage: Stage) -> bool:
    """Whether the weather is kept."""
    stage.world.set_weather(carla.WeatherParameters.HardRainNoon)
    with stage.aside():
        return stage.world.get_weather() == carla.WeatherParameters.HardRainNoon


def applied(stage: Stage) -> bool:
    """Whether settings are kept."""
    settings = stage.world.get_settings()
    settings.max_substeps = 8
    stage.world.apply_settings(settings)
    with stage.aside():
        return stage.world.get_settings().max_substeps == 8


def pulled(stage: Stage) -> bool:
    """Whether the gravity of IMU sensors is kept."""
    stage.world.set_imui_sensor_gravity(9.5)
    with stage.aside():
        kept = abs(stage.world.get_imui_sensor_gravity() - 9.5) < 1e-6
        stage.world.set_imui_sensor_gravity(9.81)
    return kept


def signal(stage: Stage, kind: str) -> carla.Landmark:
    """One of the map's signals of a type."""
    return stage.map.get_all_landmarks_of_type(kind)[0]


def in_signalled_junction(stage: Stage) -> carla.Waypoint:
    """A place before a traffic light."""

    def find() -> carla.Waypoint:
        light = stage.light.get_stop_waypoints()[0]
        return light.previous(5.0)[0]

    found: carla.Waypoint = stage.once("before a light", find)
    return found


def lights_of_junction(stage: Stage) -> bool:
    """Whether the lights of a junction are found: one that has any."""
    junctions = {found.junction_id for found in stage.map.generate_waypoints(5.0) if found.is_junction}
    return any(len(stage.world.get_traffic_lights_in_junction(number)) > 0 for number in sorted(junctions))


def an_object(stage: Stage) -> Any:
    """Something of the scene."""
    return stage.world.get_environment_objects(carla.CityObjectLabel.Any)[0]


def put_there(stage: Stage, *, trying: bool) -> bool:
    """Whether an actor is spawned, and another one attached to it."""
    with stage.aside():
        library = stage.world.get_blueprint_library()
        pose = stage.map.get_spawn_points()[20 if trying else 22]
    spawn = stage.world.try_spawn_actor if trying else stage.world.spawn_actor
    car = spawn(library.find("vehicle.audi.a2"), pose)
    sensor = spawn(library.find("sensor.other.imu"), carla.Transform(), car)
    return sensor is not None and sensor.parent.id == car.id


def textures(stage: Stage) -> tuple[list[str], carla.TextureColor]:
    """Names that could be painted, and paint."""
    with stage.aside():
        names = list(stage.world.get_names_of_all_objects())
    return names[:1] or ["nothing"], carla.TextureColor(2, 2)


def painted(stage: Stage, *, floating: bool, several: bool) -> Any:
    """Paint objects."""
    names, texture = textures(stage)
    kind = "float_color" if floating else "color"
    paint = getattr(stage.world, f"apply_{kind}_texture_to_object{'s' if several else ''}")
    return paint(names if several else names[0], carla.MaterialParameter.Diffuse, floats() if floating else texture)


def painted_all_over(stage: Stage, *, several: bool) -> Any:
    """Paint objects with all four textures at once."""
    names, texture = textures(stage)
    paint = getattr(stage.world, f"apply_textures_to_object{'s' if several else ''}")
    return paint(names if several else names[0], texture, floats(), floats(), floats())


CALLS: dict[str, Call] = {
    "World.id": lambda s: s.world.id > 0,
    "World.__str__": lambda s: "World" in str(s.world),
    "World.debug": lambda s: isinstance(s.world.debug, carla.DebugHelper),
    "World.get_map": lambda s: carla.Client("127.0.0.1", s.tap.port()).get_world().get_map().name.endswith("Linden"),
    "World.get_settings": lambda s: s.world.get_settings().fixed_delta_seconds == 0.05,
    "World.apply_settings": applied,
    "World.tick": lambda s: s.world.tick() > 0,
    "World.wait_for_tick": waited,
    "World.on_tick": told,
    "World.remove_on_tick": told,
    "World.get_snapshot": lambda s: s.world.get_snapshot().frame > 0,
    "World.get_actor": lambda s: s.world.get_actor(s.vehicle.id).id == s.vehicle.id,
    "World.get_actors": lambda s: len(s.world.get_actors()) > 10,
    "World.get_spectator": lambda s: s.world.get_spectator().type_id == "spectator",
    "World.get_blueprint_library": lambda s: len(s.world.get_blueprint_library()) > 150,
    "World.spawn_actor": lambda s: put_there(s, trying=False),
    "World.try_spawn_actor": lambda s: put_there(s, trying=True),
    "World.get_weather": lambda s: s.world.get_weather().cloudiness >= -1.0,
    "World.set_weather": kept_weather,
    "World.get_imui_sensor_gravity": lambda s: 9.0 < s.world.get_imui_sensor_gravity() < 10.0,
    "World.set_imui_sensor_gravity": pulled,
    "World.get_random_location_from_navigation": lambda s: isinstance(
        s.world.get_random_location_from_navigation(), carla.Location
    ),
    "World.set_pedestrians_cross_factor": lambda s: s.world.set_pedestrians_cross_factor(0.1),
    "World.set_pedestrians_seed": lambda s: s.world.set_pedestrians_seed(7),
    "World.get_vehicles_light_states": lambda s: s.vehicle.id in s.world.get_vehicles_light_states(),
    "World.get_traffic_light": lambda s: s.world.get_traffic_light(signal(s, "1000001")).type_id.endswith("light"),
    "World.get_traffic_light_from_opendrive_id": lambda s: (
        s.world.get_traffic_light_from_opendrive_id(s.light.get_opendrive_id()).id == s.light.id
    ),
    "World.get_traffic_lights_from_waypoint": lambda s: (
        len(s.world.get_traffic_lights_from_waypoint(in_signalled_junction(s), 30.0)) > 0
    ),
    "World.get_traffic_lights_in_junction": lights_of_junction,
    "World.get_traffic_sign": lambda s: s.world.get_traffic_sign(stop_sign(s)).type_id == "traffic.stop",
    "World.freeze_all_traffic_lights": lambda s: s.world.freeze_all_traffic_lights(False),
    "World.reset_all_traffic_lights": lambda s: s.world.reset_all_traffic_lights(),
    "World.get_lightmanager": lambda s: isinstance(s.world.get_lightmanager(), carla.LightManager),
    "World.get_level_bbs": lambda s: len(s.world.get_level_bbs(carla.CityObjectLabel.Any)) > 0,
    "World.get_environment_objects": lambda s: len(s.world.get_environment_objects(carla.CityObjectLabel.Any)) > 0,
    "World.enable_environment_objects": lambda s: s.world.enable_environment_objects({an_object(s).id}, True),
    "World.get_names_of_all_objects": lambda s: len(s.world.get_names_of_all_objects()) > 0,
    "World.cast_ray": lambda s: len(s.world.cast_ray(above(s), below(s))) > 0,
    "World.project_point": lambda s: s.world.project_point(above(s), UP * -1.0, 20.0).location.z < above(s).z,
    "World.ground_projection": lambda s: s.world.ground_projection(above(s), 20.0).location.z < above(s).z,
    "World.load_map_layer": lambda s: s.world.load_map_layer(carla.MapLayer.Buildings),
    "World.unload_map_layer": lambda s: s.world.unload_map_layer(carla.MapLayer.Particles),
    "World.set_annotations_traverse_translucency": lambda s: s.world.set_annotations_traverse_translucency(False),
    "World.apply_color_texture_to_object": lambda s: painted(s, floating=False, several=False),
    "World.apply_color_texture_to_objects": lambda s: painted(s, floating=False, several=True),
    "World.apply_float_color_texture_to_object": lambda s: painted(s, floating=True, several=False),
    "World.apply_float_color_texture_to_objects": lambda s: painted(s, floating=True, several=True),
    "World.apply_textures_to_object": lambda s: painted_all_over(s, several=False),
    "World.apply_textures_to_objects": lambda s: painted_all_over(s, several=True),
    **fields(
        "WorldSnapshot",
        lambda s: s.world.get_snapshot(),
        id=lambda number: number > 0,
        frame=lambda number: number > 0,
        frame_count=lambda n: n > 0,
        timestamp=lambda when: isinstance(when, carla.Timestamp),
        elapsed_seconds=lambda when_s: when_s > 0.0,
        delta_seconds=0.05,
        platform_timestamp=lambda when_s: when_s > 0.0,
    ),
    "WorldSnapshot.find": lambda s: s.world.get_snapshot().find(s.vehicle.id).id == s.vehicle.id,
    "WorldSnapshot.has_actor": lambda s: s.world.get_snapshot().has_actor(s.vehicle.id),
    "WorldSnapshot.__eq__": lambda s: s.world.get_snapshot() == s.world.get_snapshot(),
    "WorldSnapshot.__ne__": lambda s: not (s.world.get_snapshot() != s.world.get_snapshot()),  # noqa: SIM202
    "WorldSnapshot.__iter__": lambda s: s.vehicle.id in {found.id for found in s.world.get_snapshot()},
    "WorldSnapshot.__len__": lambda s: len(s.world.get_snapshot()) > 10,
    "WorldSnapshot.__str__": lambda s: "frame" in str(s.world.get_snapshot()),
    "DebugHelper.draw_point": lambda s: s.world.debug.draw_point(above(s), 0.1, RED, 1.0),
    "DebugHelper.draw_hud_point": lambda s: s.world.debug.draw_hud_point(above(s), 0.1, RED, 1.0),
    "DebugHelper.draw_line": lambda s: s.world.debug.draw_line(above(s), below(s), 0.1, RED, 1.0),
    "DebugHelper.draw_hud_line": lambda s: s.world.debug.draw_hud_line(above(s), below(s), 0.1, RED, 1.0),
    "DebugHelper.draw_arrow": lambda s: s.world.debug.draw_arrow(above(s), below(s), 0.1, 0.1, RED, 1.0),
    "DebugHelper.draw_hud_arrow": lambda s: s.world.debug.draw_hud_arrow(above(s), below(s), 0.1, 0.1, RED, 1.0),
    "DebugHelper.draw_box": lambda s: s.world.debug.draw_box(s.vehicle.bounding_box, carla.Rotation(), 0.1, RED, 1.0),
    "DebugHelper.draw_hud_box": lambda s: s.world.debug.draw_hud_box(
        s.vehicle.bounding_box, carla.Rotation(), 0.1, RED, 1.0
    ),
    "DebugHelper.draw_string": lambda s: s.world.debug.draw_string(above(s), "Linden", False, RED, 1.0),
    "DebugHelper.clear_debug_shape": lambda s: s.world.debug.clear_debug_shape(),
    "DebugHelper.clear_debug_string": lambda s: s.world.debug.clear_debug_string(),
    **fields(
        "EnvironmentObject",
        an_object,
        id=lambda number: number > 0,
        name=lambda text: len(text) > 0,
        type=lambda tag: isinstance(tag, carla.CityObjectLabel),
        transform=lambda pose: isinstance(pose, carla.Transform),
        bounding_box=lambda box: box.extent.length() > 0.0,
    ),
    "EnvironmentObject.__str__": lambda s: len(str(an_object(s))) > 0,
    **fields(
        "LabelledPoint",
        lambda s: s.world.ground_projection(above(s), 20.0),
        location=lambda place: isinstance(place, carla.Location),
        label=carla.CityObjectLabel.Roads,
    ),
}
