"""Shapes that clients draw into the world, kept for viewers and recordings."""

import math
from typing import NamedTuple

from linden.protocol.values.debug_shapes import DebugShape, HudArrow, HudBox, HudLine, HudPoint, Text

MOST_SHAPES = 20_000
"""More at a time are a script that never lets one go; the oldest give way. 20,000 take about 20 MB."""

_ON_SCREEN = (Text, HudPoint, HudLine, HudArrow, HudBox)
_ROUNDING_S = 1e-6  # a sum of steps that should equal a life counts as equal


class KeptShape(NamedTuple):
    """A shape and the simulated time, in s, until which it is shown."""

    shape: DebugShape
    until_s: float


class DebugShapes:
    """The shapes of an episode, oldest first. Every one is shown in one frame at least.

    Attributes:
        drawn: how many shapes clients have drawn.
        cleared: how often clients have cleared shapes.
    """

    def __init__(self) -> None:
        self.drawn = self.cleared = 0
        self._shown: list[KeptShape] = []
        self._new: list[KeptShape] = []

    @property
    def shapes(self) -> tuple[KeptShape, ...]:
        """All that is to be shown now."""
        return (*self._shown, *self._new)

    def draw(self, shape: DebugShape, now_s: float) -> bool:
        """Keep a shape; False where an older one had to give way to it.

        A life of zero or less lasts until shapes are cleared, as in CARLA since 0.9.13 (its issue 5231), but on the
        screen (text and HUD shapes) for one frame: CarlaHUD.cpp.
        """
        lasts_s = shape.life_time
        if lasts_s <= 0.0:
            lasts_s = 0.0 if isinstance(shape.primitive, _ON_SCREEN) else math.inf
        self._new.append(KeptShape(shape, now_s + lasts_s))
        self.drawn += 1
        if len(self._shown) + len(self._new) <= MOST_SHAPES:
            return True
        (self._shown or self._new).pop(0)
        return False

    def step(self, now_s: float) -> None:
        """Drop the expired shapes."""
        if self._shown or self._new:
            self._shown = [kept for kept in self._shown if now_s <= kept.until_s + _ROUNDING_S] + self._new
            self._new = []

    def clear_shapes(self) -> None:
        """Take away all that was drawn into the world; what is on the screen stays, as in DebugShapeDrawer.cpp."""
        self._keep(on_screen=True)

    def clear_strings(self) -> None:
        """Take away all text."""
        self.cleared += 1
        self._shown = [kept for kept in self._shown if not isinstance(kept.shape.primitive, Text)]
        self._new = [kept for kept in self._new if not isinstance(kept.shape.primitive, Text)]

    def _keep(self, *, on_screen: bool) -> None:
        self.cleared += 1
        self._shown = [kept for kept in self._shown if isinstance(kept.shape.primitive, _ON_SCREEN) is on_screen]
        self._new = [kept for kept in self._new if isinstance(kept.shape.primitive, _ON_SCREEN) is on_screen]
