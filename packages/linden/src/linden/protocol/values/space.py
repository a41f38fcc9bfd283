"""Places, directions and boxes in CARLA's left-handed world: x east, y south, z up; metres and degrees."""

from typing import NamedTuple


class Vector2D(NamedTuple):
    """A pair; the unit is that of the field it stands in."""

    x: float = 0.0
    y: float = 0.0


class Vector3D(NamedTuple):
    """A place in m, or a direction, velocity in m/s, force in N: the field it stands in says which."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


class Rotation(NamedTuple):
    """Degrees. Pitch: nose up; yaw: clockwise seen from above; roll: right side down (all positive)."""

    pitch: float = 0.0
    yaw: float = 0.0
    roll: float = 0.0


class Transform(NamedTuple):
    """A pose: where its origin lies (m) and how it is turned (degrees)."""

    location: Vector3D = Vector3D()
    rotation: Rotation = Rotation()


class BoundingBox(NamedTuple):
    """An oriented box: centre and half sizes in m. Local to its actor unless a function says otherwise."""

    location: Vector3D = Vector3D()
    extent: Vector3D = Vector3D()
    rotation: Rotation = Rotation()
    actor_id: int = 0


class GeoLocation(NamedTuple):
    """Latitude and longitude in degrees, altitude in m."""

    latitude: float = 0.0
    longitude: float = 0.0
    altitude: float = 0.0
