"""The satellite receiver: where a place on the map lies on Earth, as CARLA 0.9.16 and its client compute it."""

import math

from linden.protocol.values.space import GeoLocation, Vector3D
from linden.sensors.devices.attributes import GnssSpec
from linden.sensors.devices.noise import gaussian

EARTH_RADIUS_M = 6_378_137.0
SCALE = 0.9996
"""Radius and scale on the middle meridian of the sphere that CARLA projects from; those of UTM."""


def geolocation(location: Vector3D, origin_latitude_deg: float, origin_longitude_deg: float) -> GeoLocation:
    """Return where a place in the world (m) lies; equal to the client's ``Map.transform_to_geolocation``.

    Spherical transverse Mercator, inverse: Snyder 1987, "Map Projections: A Working Manual", equations 8-6 and 8-7.
    CARLA feeds its y, which points south, in as if it pointed north: latitude **grows** southwards. So does ours.
    """
    across = location.x / (SCALE * EARTH_RADIUS_M)
    along = location.y / (SCALE * EARTH_RADIUS_M) + math.radians(origin_latitude_deg)
    latitude = math.asin(math.sin(along) / math.cosh(across))
    longitude = math.radians(origin_longitude_deg) + math.atan2(math.sinh(across), math.cos(along))
    return GeoLocation(math.degrees(latitude), math.degrees(longitude), location.z)


def measure(spec: GnssSpec, number: int, location: Vector3D, origin_deg: tuple[float, float]) -> GeoLocation:
    """Return measurement ``number`` of a receiver at ``location`` (world, m): degrees, degrees, m.

    ``origin_deg``: latitude and longitude of the map's origin.
    """
    exact = geolocation(location, *origin_deg)
    errors = gaussian(spec.seed, number, spec.deviation)
    latitude, longitude, altitude = (
        value + bias + error for value, bias, error in zip(exact, spec.bias, errors, strict=True)
    )
    return GeoLocation(latitude, longitude, altitude)
