"""Shapes that a client draws into the world to see what its program thinks. Source of names: LibCarla 0.9.16."""

from linden.errors import Refusal
from linden.handlers.context import Context
from linden.handlers.registry import method
from linden.scene.debug_shapes import MOST_SHAPES
from linden.values.debug import DebugShape

_BRIGHTEST = 255


@method("draw_debug_shape")
def draw_debug_shape(context: Context, shape: DebugShape) -> None:
    """Keep a shape for whoever shows the world, for as long as it lives in simulated time."""
    if not all(0 <= part <= _BRIGHTEST for part in shape.color):
        raise Refusal(f"the colour of a shape has parts from 0 to {_BRIGHTEST}, not {shape.color}")
    episode = context.simulation.episode
    if not episode.surroundings.debug.draw(shape, episode.elapsed_s):
        context.warn_once(
            f"more than {MOST_SHAPES} debug shapes at a time: the oldest are given up; draw with a life_time above 0, "
            f"for zero or less means until they are cleared"
        )


@method("clear_debug_shape")
def clear_debug_shape(context: Context) -> None:
    """Take away what was drawn into the world; text and what is drawn on the screen stay, as in CARLA."""
    context.simulation.episode.surroundings.debug.clear_shapes()


@method("clear_debug_string")
def clear_debug_string(context: Context) -> None:
    """Take away all text."""
    context.simulation.episode.surroundings.debug.clear_strings()
