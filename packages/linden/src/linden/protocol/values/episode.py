"""Values of a whole episode: settings, weather, map. Source: ``carla/rpc``, 0.9.16."""

from typing import NamedTuple

from linden.protocol.values.space import BoundingBox, Transform, Vector3D


class EpisodeSettings(NamedTuple):
    """How time passes. Seconds and metres; ``fixed_delta_seconds`` None means a variable step."""

    synchronous_mode: bool = False
    no_rendering_mode: bool = False
    fixed_delta_seconds: float | None = None
    substepping: bool = True
    max_substep_delta_time: float = 0.01
    max_substeps: int = 10
    max_culling_distance: float = 0.0
    deterministic_ragdolls: bool = True
    tile_stream_distance: float = 3000.0
    actor_active_distance: float = 2000.0
    spectator_as_ego: bool = True


class OpendriveGenerationParameters(NamedTuple):
    """How a mesh is made of an OpenDRIVE text, in m."""

    vertex_distance: float = 2.0
    max_road_length: float = 50.0
    wall_height: float = 1.0
    additional_width: float = 0.6
    smooth_junctions: bool = True
    enable_mesh_visibility: bool = True
    enable_pedestrian_navigation: bool = True


class WeatherParameters(NamedTuple):
    """Percent, degrees and metres; negative values mean the map's own default and are kept as they are."""

    cloudiness: float = 0.0
    precipitation: float = 0.0
    precipitation_deposits: float = 0.0
    wind_intensity: float = 0.0
    sun_azimuth_angle: float = 0.0
    sun_altitude_angle: float = 0.0
    fog_density: float = 0.0
    fog_distance: float = 0.0
    fog_falloff: float = 0.0
    wetness: float = 0.0
    scattering_intensity: float = 0.0
    mie_scattering_scale: float = 0.0
    rayleigh_scattering_scale: float = 0.0331
    dust_storm: float = 0.0


class MapInfo(NamedTuple):
    """A map's name and its recommended spawn points."""

    name: str
    spawn_points: tuple[Transform, ...]


class EnvironmentObject(NamedTuple):
    """One thing of the scenery; box in the world frame."""

    transform: Transform
    bounding_box: BoundingBox
    id: int
    name: str
    type: int


class LabelledPoint(NamedTuple):
    """Where a ray hit, and the semantic tag of what it hit."""

    location: Vector3D
    label: int


class LightState(NamedTuple):
    """One lamp of a street or house: colour 0 to 255, intensity in lumens, group a carla.LightGroup."""

    id: int
    location: Vector3D
    intensity: float
    group: int
    color: tuple[int, int, int]
    active: bool


CLEAR_NOON = WeatherParameters(
    cloudiness=5.0,
    wind_intensity=10.0,
    sun_azimuth_angle=-1.0,
    sun_altitude_angle=45.0,
    fog_density=2.0,
    fog_distance=0.75,
    fog_falloff=0.1,
    scattering_intensity=1.0,
    mie_scattering_scale=0.03,
    rayleigh_scattering_scale=0.0331,
)
"""The client's preset of this name. CARLA's towns have a weather of their own, which no source states; all are by day.

With the sun on the horizon, which is where zeros would put it, the Traffic Manager turns its vehicles' lights on.
"""
