"""The scene: its objects and layers, and what rays meet in it. Source of names and meanings: ``CarlaServer.cpp``."""

from typing import Annotated, TypeAlias

from linden.errors import Refusal
from linden.handlers.context import Context
from linden.handlers.registry import method
from linden.simulation import queries
from linden.values.episode import EnvironmentObject, LabelledPoint
from linden.values.space import BoundingBox, Vector3D
from linden.wire.decode import U8, U16, U32, U64, DecodedBy

Unread: TypeAlias = Annotated[object, DecodedBy(lambda value: value)]
"""An argument that is refused whatever it says; a texture of a million pixels is not worth looking at first."""

_NOWHERE = LabelledPoint(Vector3D(), 0)


@method("get_all_level_BBs")
def get_all_level_bbs(context: Context, tag: U8) -> list[BoundingBox]:
    """Return the boxes of everything of a semantic tag, in the world; 255 is any tag.

    The surface of roads and pavements is no object here, so it has no box.
    """
    return queries.level_boxes(context.simulation.episode, tag)


@method("get_environment_objects")
def get_environment_objects(context: Context, tag: U8) -> list[EnvironmentObject]:
    """Return the objects of the scene that have a semantic tag; 255 is any tag. Boxes are in the world."""
    return queries.environment_objects(context.simulation.episode, tag)


@method("enable_environment_objects")
def enable_environment_objects(context: Context, object_ids: list[U64], enable: bool) -> None:  # noqa: FBT001 - the wire's order
    """Let objects disappear, so that nothing meets or hits them, or appear again."""
    unknown = context.simulation.episode.surroundings.enable(object_ids, enabled=enable)
    if unknown:
        context.warn_once(
            f"enable_environment_objects: no object has the id {unknown[0]} (get_environment_objects lists them)"
        )


@method("get_names_of_all_objects")
def get_names_of_all_objects(context: Context) -> list[str]:
    """Return the names of the things that the scene's objects are parts of."""
    return queries.object_names(context.simulation.episode)


@method("load_map_layer")
def load_map_layer(context: Context, layers: U16) -> None:
    """Let the houses, trees, lamps or walls appear again; CARLA's other layers hold nothing here, nor in most towns."""
    context.simulation.episode.surroundings.load_layers(layers)


@method("unload_map_layer")
def unload_map_layer(context: Context, layers: U16) -> None:
    """Let the houses, trees, lamps or walls disappear."""
    context.simulation.episode.surroundings.unload_layers(layers)


@method("cast_ray")
def cast_ray(context: Context, start: Vector3D, end: Vector3D) -> list[LabelledPoint]:
    """Return every surface that the way from one point to another crosses, in its order."""
    return queries.cast_ray(context.simulation.episode, start, end)


@method("project_point")
def project_point(
    context: Context, start: Vector3D, direction: Vector3D, search_distance: float
) -> tuple[bool, LabelledPoint]:
    """Return whether there is a surface in a direction within a distance in m, and where."""
    found = queries.project_point(context.simulation.episode, start, direction, search_distance)
    return (True, found) if found is not None else (False, _NOWHERE)


@method("get_light_boxes")
def get_light_boxes(context: Context, actor_id: U32) -> list[BoundingBox]:
    """Return the boxes of a traffic light's heads, in the world."""
    return queries.light_boxes(context.simulation.episode, actor_id)


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
    """Say in the log why it changes nothing."""
    context.warn_once(
        "set_annotations_traverse_translucency: nothing in linden's scene is translucent, so what annotations show is "
        "the same with it and without"
    )


@method("console_command")
def console_command(_context: Context, command: str) -> bool:
    """Refuse."""
    raise Refusal(f"console_command '{command[:80]}' is for Unreal's console, which linden does not have")
