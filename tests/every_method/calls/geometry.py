"""Vectors, rotations, transforms, boxes, colours, textures: the client's own arithmetic."""

import math
from typing import Any

import carla
import pytest

from every_method.call import Call
from every_method.entries import comparisons, fields
from every_method.stage import Stage


def xyz(vector: Any) -> tuple[float, float, float]:
    """Return a vector's components."""
    return vector.x, vector.y, vector.z


def near(got: Any, *expected: float) -> bool:
    """Whether a vector has these components, to the precision of a float of 32 bits."""
    parts = (got.x, got.y, got.z) if len(expected) == 3 else (got.x, got.y)
    return bool(parts == pytest.approx(expected, abs=1e-5))


def three() -> carla.Vector3D:
    """A vector of which nothing is round."""
    return carla.Vector3D(1.0, 2.0, 2.0)


def two() -> carla.Vector2D:
    """Likewise, in the plane."""
    return carla.Vector2D(3.0, 4.0)


def place() -> carla.Location:
    """Likewise, as a place."""
    return carla.Location(1.0, 2.0, 2.0)


def turned() -> carla.Transform:
    """A pose 10 m east, heading south."""
    return carla.Transform(carla.Location(x=10.0), carla.Rotation(yaw=90.0))


def box() -> carla.BoundingBox:
    """A box of 2 x 4 x 6 m around its origin."""
    return carla.BoundingBox(carla.Location(), carla.Vector3D(1.0, 2.0, 3.0))


def added_to(vector: Any, other: Any) -> Any:
    """Return what ``+=`` makes."""
    vector += other
    return vector


def taken_from(vector: Any, other: Any) -> Any:
    """Return what ``-=`` makes."""
    vector -= other
    return vector


def multiplied(vector: Any, factor: float) -> Any:
    """Return what ``*=`` makes."""
    vector *= factor
    return vector


def texture(make: Any, colour: Any) -> bool:
    """Whether a texture keeps the colour of a pixel."""
    image = make
    image.set(1, 1, colour)
    return bool(image.get(1, 1) == colour)


def floats(width: int = 2, height: int = 2) -> carla.TextureFloatColor:
    """A texture of floats; its constructor is that of any value, though the stub has none."""
    return carla.TextureFloatColor(width, height)


def resized(image: Any) -> bool:
    """Whether a texture takes other dimensions."""
    image.set_dimensions(3, 1)
    return (image.width, image.height) == (3, 1)


def corners_seen(_: Stage) -> bool:
    """Whether the corners of the box seen from a turned pose lie where they should."""
    found = {tuple(round(part, 3) for part in xyz(corner)) for corner in box().get_world_vertices(turned())}
    return found == {(10.0 + x, y, z) for x in (-2.0, 2.0) for y in (-1.0, 1.0) for z in (-3.0, 3.0)}


CALLS: dict[str, Call] = {
    "Vector2D.__init__": lambda _: near(carla.Vector2D(1.0), 1.0, 0.0),
    **fields("Vector2D", lambda _: two(), x=3.0, y=4.0),
    **comparisons("Vector2D", two, carla.Vector2D),
    "Vector2D.length": lambda _: two().length() == 5.0,
    "Vector2D.squared_length": lambda _: two().squared_length() == 25.0,
    "Vector2D.make_unit_vector": lambda _: near(two().make_unit_vector(), 0.6, 0.8),
    "Vector2D.__add__": lambda _: near(two() + two(), 6.0, 8.0),
    "Vector2D.__sub__": lambda _: near(two() - two(), 0.0, 0.0),
    "Vector2D.__mul__": lambda _: near(two() * 2.0, 6.0, 8.0),
    "Vector2D.__rmul__": lambda _: near(2.0 * two(), 6.0, 8.0),
    "Vector2D.__truediv__": lambda _: near(two() / 2.0, 1.5, 2.0),
    "Vector2D.__rtruediv__": lambda _: near(2.0 / two(), 1.5, 2.0),
    "Vector2D.__iadd__": lambda _: near(added_to(two(), two()), 6.0, 8.0),
    "Vector2D.__isub__": lambda _: near(taken_from(two(), two()), 0.0, 0.0),
    "Vector2D.__imul__": lambda _: near(multiplied(two(), 2.0), 6.0, 8.0),
    "Vector2D.__idiv__": lambda _: near(two().__idiv__(2.0), 1.5, 2.0),
    "Vector3D.__init__": lambda _: near(carla.Vector3D(y=1.0), 0.0, 1.0, 0.0),
    **fields("Vector3D", lambda _: three(), x=1.0, y=2.0, z=2.0),
    **comparisons("Vector3D", three, carla.Vector3D),
    "Vector3D.length": lambda _: three().length() == 3.0,
    "Vector3D.squared_length": lambda _: three().squared_length() == 9.0,
    "Vector3D.make_unit_vector": lambda _: near(three().make_unit_vector(), 1 / 3, 2 / 3, 2 / 3),
    "Vector3D.cross": lambda _: near(carla.Vector3D(x=1.0).cross(carla.Vector3D(y=1.0)), 0.0, 0.0, 1.0),
    "Vector3D.dot": lambda _: three().dot(three()) == 9.0,
    "Vector3D.dot_2d": lambda _: three().dot_2d(three()) == 5.0,
    "Vector3D.distance": lambda _: three().distance(carla.Vector3D()) == 3.0,
    "Vector3D.distance_squared": lambda _: three().distance_squared(carla.Vector3D()) == 9.0,
    "Vector3D.distance_2d": lambda _: three().distance_2d(carla.Vector3D()) == pytest.approx(math.sqrt(5.0)),
    "Vector3D.distance_squared_2d": lambda _: three().distance_squared_2d(carla.Vector3D()) == 5.0,
    "Vector3D.get_vector_angle": lambda _: (
        carla.Vector3D(x=1.0).get_vector_angle(carla.Vector3D(y=1.0)) == pytest.approx(math.pi / 2)
    ),
    "Vector3D.__abs__": lambda _: near(abs(carla.Vector3D(-1.0, 2.0, -3.0)), 1.0, 2.0, 3.0),
    "Vector3D.__add__": lambda _: near(three() + three(), 2.0, 4.0, 4.0),
    "Vector3D.__sub__": lambda _: near(three() - three(), 0.0, 0.0, 0.0),
    "Vector3D.__mul__": lambda _: near(three() * 2.0, 2.0, 4.0, 4.0),
    "Vector3D.__rmul__": lambda _: near(2.0 * three(), 2.0, 4.0, 4.0),
    "Vector3D.__truediv__": lambda _: near(three() / 2.0, 0.5, 1.0, 1.0),
    "Vector3D.__rtruediv__": lambda _: near(2.0 / three(), 0.5, 1.0, 1.0),
    "Vector3D.__iadd__": lambda _: near(added_to(three(), three()), 2.0, 4.0, 4.0),
    "Vector3D.__isub__": lambda _: near(taken_from(three(), three()), 0.0, 0.0, 0.0),
    "Vector3D.__imul__": lambda _: near(multiplied(three(), 2.0), 2.0, 4.0, 4.0),
    "Vector3D.__idiv__": lambda _: near(three().__idiv__(2.0), 0.5, 1.0, 1.0),
    "Location.__init__": lambda _: near(carla.Location(three()), 1.0, 2.0, 2.0),
    **fields("Location", lambda _: place(), x=1.0, y=2.0, z=2.0),
    **comparisons("Location", place, carla.Location),
    "Location.distance": lambda _: place().distance(carla.Location()) == 3.0,
    "Location.__abs__": lambda _: near(abs(carla.Location(x=-1.0)), 1.0, 0.0, 0.0),
    "Location.__iadd__": lambda _: near(added_to(place(), place()), 2.0, 4.0, 4.0),
    "Location.__isub__": lambda _: near(taken_from(place(), place()), 0.0, 0.0, 0.0),
    "Rotation.__init__": lambda _: carla.Rotation(1.0, 2.0, 3.0).roll == 3.0,
    **fields("Rotation", lambda _: carla.Rotation(1.0, 2.0, 3.0), pitch=1.0, yaw=2.0, roll=3.0),
    **comparisons("Rotation", lambda: carla.Rotation(yaw=1.0), carla.Rotation),
    "Rotation.get_forward_vector": lambda _: near(carla.Rotation(yaw=90.0).get_forward_vector(), 0.0, 1.0, 0.0),
    "Rotation.get_right_vector": lambda _: near(carla.Rotation(yaw=90.0).get_right_vector(), -1.0, 0.0, 0.0),
    "Rotation.get_up_vector": lambda _: near(carla.Rotation(yaw=90.0).get_up_vector(), 0.0, 0.0, 1.0),
    "Transform.__init__": lambda _: carla.Transform().location == carla.Location(),
    **fields("Transform", lambda _: turned(), location=carla.Location(x=10.0), rotation=carla.Rotation(yaw=90.0)),
    **comparisons("Transform", turned, carla.Transform),
    "Transform.transform": lambda _: near(turned().transform(carla.Location(x=1.0)), 10.0, 1.0, 0.0),
    "Transform.inverse_transform": lambda _: near(turned().inverse_transform(carla.Location(10.0, 1.0)), 1.0, 0.0, 0.0),
    "Transform.transform_vector": lambda _: near(turned().transform_vector(carla.Vector3D(x=1.0)), 0.0, 1.0, 0.0),
    "Transform.get_forward_vector": lambda _: near(turned().get_forward_vector(), 0.0, 1.0, 0.0),
    "Transform.get_right_vector": lambda _: near(turned().get_right_vector(), -1.0, 0.0, 0.0),
    "Transform.get_up_vector": lambda _: near(turned().get_up_vector(), 0.0, 0.0, 1.0),
    "Transform.get_matrix": lambda _: [row[3] for row in turned().get_matrix()] == [10.0, 0.0, 0.0, 1.0],
    "Transform.get_inverse_matrix": lambda _: (
        turned().get_inverse_matrix()[1][3] == pytest.approx(10.0) and len(turned().get_inverse_matrix()) == 4
    ),
    "BoundingBox.__init__": lambda _: near(box().extent, 1.0, 2.0, 3.0),
    **fields(
        "BoundingBox",
        lambda _: box(),
        location=carla.Location(),
        extent=carla.Vector3D(1.0, 2.0, 3.0),
        rotation=carla.Rotation(),
        actor_id=lambda number: number >= 0,  # of a box that a script makes: whatever was in the client's memory
    ),
    **comparisons("BoundingBox", box, lambda: carla.BoundingBox(carla.Location(), carla.Vector3D())),
    "BoundingBox.contains": lambda _: (
        box().contains(carla.Location(11.9, 0.9, 2.9), turned()) and not box().contains(carla.Location(), turned())
    ),
    "BoundingBox.get_local_vertices": lambda _: {abs(corner.z) for corner in box().get_local_vertices()} == {3.0},
    "BoundingBox.get_world_vertices": corners_seen,
    "Color.__init__": lambda _: carla.Color(1, 2, 3).a == 255,
    **fields("Color", lambda _: carla.Color(1, 2, 3, 4), r=1, g=2, b=3, a=4),
    **comparisons("Color", lambda: carla.Color(1, 2, 3), carla.Color),
    "FloatColor.__init__": lambda _: carla.FloatColor(0.5).a == 1.0,
    **fields("FloatColor", lambda _: carla.FloatColor(0.25, 0.5, 0.75, 1.0), r=0.25, g=0.5, b=0.75, a=1.0),
    **{
        member: call
        for member, call in comparisons("FloatColor", lambda: carla.FloatColor(0.5), carla.FloatColor).items()
        if member != "FloatColor.__str__"  # prints as any object does
    },
    "TextureColor.__init__": lambda _: carla.TextureColor(4, 2).width == 4,
    **fields("TextureColor", lambda _: carla.TextureColor(4, 2), width=4, height=2),
    "TextureColor.get": lambda _: carla.TextureColor(2, 2).get(0, 0) == carla.Color(0, 0, 0, 0),
    "TextureColor.set": lambda _: texture(carla.TextureColor(2, 2), carla.Color(9, 8, 7, 6)),
    "TextureColor.set_dimensions": lambda _: resized(carla.TextureColor(2, 2)),
    "TextureFloatColor.__init__": lambda _: floats(4).width == 4,
    **fields("TextureFloatColor", lambda _: floats(4), width=4, height=2),
    "TextureFloatColor.get": lambda _: isinstance(floats().get(0, 0), carla.FloatColor),
    "TextureFloatColor.set": lambda _: texture(floats(), carla.FloatColor(0.5, 0.25, 0.125, 1.0)),
    "TextureFloatColor.set_dimensions": lambda _: resized(floats()),
    "GeoLocation.__init__": lambda _: carla.GeoLocation(1.0).longitude == 0.0,
    **fields(
        "GeoLocation", lambda _: carla.GeoLocation(48.0, 11.0, 500.0), latitude=48.0, longitude=11.0, altitude=500.0
    ),
    **comparisons("GeoLocation", lambda: carla.GeoLocation(1.0), carla.GeoLocation),
}
