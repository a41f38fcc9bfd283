"""Drawn shapes live in simulated time, each for one frame at least, and never take all memory."""

import pytest

from linden.protocol.values.debug_shapes import DebugShape, HudPoint, Point, Primitive, Text
from linden.protocol.values.space import Vector3D
from linden.scenery.scene import debug_shapes
from linden.scenery.scene.debug_shapes import DebugShapes

RED = (255, 0, 0)
DOT, DOT_ON_SCREEN, WORD = (
    Point(Vector3D(), 0.1),
    HudPoint(Vector3D(), 4.0),
    Text(Vector3D(), "here", draw_shadow=False),
)


def shape(primitive: Primitive, life_s: float) -> DebugShape:
    return DebugShape(primitive, RED, life_s, persistent_lines=True)


def shown(shapes: DebugShapes) -> list[Primitive]:
    return [kept.shape.primitive for kept in shapes.shapes]


@pytest.mark.parametrize(
    ("primitive", "life_s", "frames"),
    [
        pytest.param(DOT, 0.1, 2, id="as long as it says"),
        pytest.param(DOT, 0.01, 1, id="less than a frame is one"),
        pytest.param(DOT, 0.0, 9, id="zero: until cleared"),
        pytest.param(DOT, -1.0, 9, id="less than zero: until cleared"),
        pytest.param(WORD, -1.0, 1, id="on the screen less than zero is a frame"),
        pytest.param(DOT_ON_SCREEN, 0.0, 1, id="on the screen zero is a frame"),
        pytest.param(WORD, 0.2, 4, id="on the screen as long as it says"),
    ],
)
def test_a_shape_is_shown_for_its_life(primitive: Primitive, life_s: float, frames: int) -> None:
    shapes = DebugShapes()
    shapes.draw(shape(primitive, life_s), 3.0)
    count = 0
    for frame in range(1, 10):
        shapes.step(3.0 + 0.05 * frame)
        count += len(shapes.shapes)
    assert count == frames


def test_clearing_shapes_leaves_what_is_on_the_screen_and_clearing_text_the_rest() -> None:
    shapes = DebugShapes()
    for primitive in (DOT, WORD, DOT_ON_SCREEN):
        shapes.draw(shape(primitive, 9.0), 0.0)
    shapes.clear_shapes()
    assert shown(shapes) == [WORD, DOT_ON_SCREEN]
    shapes.step(0.05)
    shapes.clear_strings()
    assert shown(shapes) == [DOT_ON_SCREEN]


def test_too_many_shapes_push_out_the_oldest(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(debug_shapes, "MOST_SHAPES", 3)
    shapes = DebugShapes()
    kept = [shapes.draw(shape(Point(Vector3D(float(number)), 0.1), 0.0), 0.0) for number in range(2)]
    shapes.step(0.05)
    kept += [shapes.draw(shape(Point(Vector3D(float(number)), 0.1), 0.0), 0.0) for number in range(2, 5)]
    assert kept == [True, True, True, False, False]
    assert [primitive.location.x for primitive in shown(shapes)] == [2.0, 3.0, 4.0]
