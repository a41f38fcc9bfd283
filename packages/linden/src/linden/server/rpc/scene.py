"""The surroundings of the actors: objects and layers, ray casts, street lamps, weather, debug shapes.

Source of names and meanings: LibCarla 0.9.16 and ``CarlaServer.cpp``. ``carla.LightManager`` turns the street lamps on
and off; its calls name their client as ``host:port``, the same for all clients
(:mod:`linden.scenery.scene.lamp_states`).
"""

from typing import Annotated, TypeAlias

from linden.errors import Refusal
from linden.protocol.values.debug_shapes import DebugShape
from linden.protocol.values.enums import LightGroup
from linden.protocol.values.episode import EnvironmentObject, LabelledPoint, LightState, WeatherParameters
from linden.protocol.values.space import BoundingBox, Vector3D
from linden.protocol.wire.decode import U8, U16, U32, U64, DecodedBy
from linden.scenery.scene.debug_shapes import MOST_SHAPES
from linden.server.rpc.context import Context
from linden.server.rpc.registry import method
from linden.simulation import queries

Unread: TypeAlias = Annotated[object, DecodedBy(lambda value: value)]
"""An argument that is refused whatever it says; a texture of a million pixels is not worth looking at first."""

_NOWHERE = LabelledPoint(Vector3D(), 0)


@method("get_all_level_BBs")
def get_all_level_bbs(context: Context, tag: U8) -> list[BoundingBox]:
    """Return the boxes of everything of a semantic tag, in the world; 255 is any tag.

    The surface of roads and pavements is no object here, so it has no box.
    """
    return queries.level_boxes(context.world.episode, tag)


@method("get_environment_objects")
def get_environment_objects(context: Context, tag: U8) -> list[EnvironmentObject]:
    """Return the objects of the scene that have a semantic tag; 255 is any tag. Boxes are in the world."""
    return queries.environment_objects(context.world.episode, tag)


@method("enable_environment_objects")
def enable_environment_objects(context: Context, object_ids: list[U64], enable: bool) -> None:  # noqa: FBT001 - the wire's order
    """Let objects disappear, so that nothing meets or hits them, or appear again."""
    unknown = context.world.episode.surroundings.enable(object_ids, enabled=enable)
    if unknown:
        context.warn_once(
            f"enable_environment_objects: no object has the id {unknown[0]} (get_environment_objects lists them)"
        )


@method("get_names_of_all_objects")
def get_names_of_all_objects(context: Context) -> list[str]:
    """Return the names of the things that the scene's objects are parts of."""
    return queries.object_names(context.world.episode)


@method("load_map_layer")
def load_map_layer(context: Context, layers: U16) -> None:
    """Let the houses, trees, lamps or walls appear again; CARLA's other layers hold nothing here, nor in most towns."""
    context.world.episode.surroundings.load_layers(layers)


@method("unload_map_layer")
def unload_map_layer(context: Context, layers: U16) -> None:
    """Let the houses, trees, lamps or walls disappear."""
    context.world.episode.surroundings.unload_layers(layers)


@method("cast_ray")
def cast_ray(context: Context, start: Vector3D, end: Vector3D) -> list[LabelledPoint]:
    """Return every surface that the way from one point to another crosses, in its order."""
    return queries.cast_ray(context.world.episode, start, end)


@method("project_point")
def project_point(
    context: Context, start: Vector3D, direction: Vector3D, search_distance: float
) -> tuple[bool, LabelledPoint]:
    """Return whether there is a surface in a direction within a distance in m, and where."""
    found = queries.project_point(context.world.episode, start, direction, search_distance)
    return (True, found) if found is not None else (False, _NOWHERE)


@method("get_light_boxes")
def get_light_boxes(context: Context, actor_id: U32) -> list[BoundingBox]:
    """Return the boxes of a traffic light's heads, in the world."""
    return queries.light_boxes(context.world.episode, actor_id)


@method("apply_color_texture_to_objects")
def apply_color_texture_to_objects(_context: Context, names: list[str], _parameter: Unread, _texture: Unread) -> None:
    """Refuse."""
    raise Refusal(_no_textures(names))


@method("apply_float_color_texture_to_objects")
def apply_float_color_texture_to_objects(
    _context: Context, names: list[str], _parameter: Unread, _texture: Unread
) -> None:
    """Refuse."""
    raise Refusal(_no_textures(names))


def _no_textures(names: list[str]) -> str:
    meant = f"'{names[0]}'" if len(names) == 1 else f"{len(names)} objects"
    return (
        f"no texture can be applied to {meant}: linden's scene is made of plain boxes with semantic tags; textures "
        f"need the materials of CARLA's own towns, and Unreal to draw them"
    )


@method("set_annotations_traverse_translucency")
def set_annotations_traverse_translucency(context: Context, _enable: bool) -> None:  # noqa: FBT001 - the wire's order
    """Warn in the log that this setting changes nothing, because no object of the scene is translucent."""
    context.warn_once(
        "set_annotations_traverse_translucency: nothing in linden's scene is translucent, so what annotations show is "
        "the same with it and without"
    )


@method("console_command")
def console_command(_context: Context, command: str) -> bool:
    """Refuse."""
    raise Refusal(f"console_command '{command[:80]}' is for Unreal's console, which linden does not have")


_BRIGHTEST = 255


@method("query_lights_state")
def query_lights_state(context: Context, _client: str) -> tuple[LightState, ...]:
    """Return how all lamps stand."""
    return context.world.episode.surroundings.lamp_states()


@method("update_lights_state")
def update_lights_state(
    context: Context,
    _client: str,
    lights: list[LightState],
    _discard_client: bool,  # noqa: FBT001 - the wire's order
) -> None:
    """Change lamps; the next snapshots tell all clients to ask anew."""
    for light in lights:
        _check(light)
    unknown = context.world.episode.surroundings.lamps.update(lights)
    if unknown:
        context.warn_once(
            f"update_lights_state: no lamp has the id {unknown[0]} (get_all_lights lists those there are)"
        )


@method("update_day_night_cycle")
def update_day_night_cycle(context: Context, _client: str, active: bool) -> None:  # noqa: FBT001 - the wire's order
    """Let the sun switch the lamps, or leave them to the clients."""
    episode = context.world.episode
    episode.surroundings.lamps.day_night_cycle = active
    episode.surroundings.lamps.follow_sun(episode.weather)


def _check(light: LightState) -> None:
    """Refuse what could not be sent back to other clients."""
    if not all(0 <= part <= _BRIGHTEST for part in light.color):
        raise Refusal(f"the colour of lamp {light.id} has parts from 0 to {_BRIGHTEST}, not {light.color}")
    if light.group not in tuple(LightGroup):
        raise Refusal(
            f"lamp {light.id} cannot belong to group {light.group}; groups are 0 none, 1 vehicle, 2 street, "
            f"3 building, 4 other"
        )


@method("get_weather_parameters")
def get_weather_parameters(context: Context) -> WeatherParameters:
    """Return the weather as it was set."""
    return context.world.episode.weather


@method("set_weather_parameters")
def set_weather_parameters(context: Context, weather: WeatherParameters) -> None:
    """Keep the weather; negative values mean the map's own default and are returned as they came."""
    episode = context.world.episode
    episode.weather = weather
    episode.surroundings.lamps.follow_sun(weather)


@method("get_imui_gravity")
def get_imui_gravity(context: Context) -> float:
    """Return the gravity that IMU sensors add, in m/s²."""
    return context.world.episode.imu_gravity_mps2


@method("set_imui_gravity")
def set_imui_gravity(context: Context, gravity_mps2: float) -> None:
    """Set the gravity that IMU sensors add."""
    context.world.episode.imu_gravity_mps2 = gravity_mps2


@method("draw_debug_shape")
def draw_debug_shape(context: Context, shape: DebugShape) -> None:
    """Keep a shape for viewers and recordings until its simulated lifetime ends."""
    if not all(0 <= part <= _BRIGHTEST for part in shape.color):
        raise Refusal(f"the colour of a shape has parts from 0 to {_BRIGHTEST}, not {shape.color}")
    episode = context.world.episode
    if not episode.surroundings.debug.draw(shape, episode.elapsed_s):
        context.warn_once(
            f"more than {MOST_SHAPES} debug shapes at a time: the oldest are given up; draw with a life_time above 0, "
            f"for zero or less means until they are cleared"
        )


@method("clear_debug_shape")
def clear_debug_shape(context: Context) -> None:
    """Take away what was drawn into the world; text and what is drawn on the screen stay, as in CARLA."""
    context.world.episode.surroundings.debug.clear_shapes()


@method("clear_debug_string")
def clear_debug_string(context: Context) -> None:
    """Take away all text."""
    context.world.episode.surroundings.debug.clear_strings()
