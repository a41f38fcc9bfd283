"""Weather, settings, time stamps, generation of maps: values that scripts make and hand over."""

import carla

from every_method.call import Call
from every_method.entries import comparisons, fields
from every_method.stage import Stage

PRESETS = {
    "ClearNoon": (5.0, 45.0),
    "CloudyNoon": (60.0, 45.0),
    "WetNoon": (5.0, 45.0),
    "WetCloudyNoon": (60.0, 45.0),
    "SoftRainNoon": (20.0, 45.0),
    "MidRainyNoon": (60.0, 45.0),
    "HardRainNoon": (100.0, 45.0),
    "ClearSunset": (5.0, 15.0),
    "CloudySunset": (60.0, 15.0),
    "WetSunset": (5.0, 15.0),
    "WetCloudySunset": (60.0, 15.0),
    "SoftRainSunset": (20.0, 15.0),
    "MidRainSunset": (60.0, 15.0),
    "HardRainSunset": (100.0, 15.0),
    "ClearNight": (5.0, -90.0),
    "CloudyNight": (60.0, -90.0),
    "WetNight": (5.0, -90.0),
    "WetCloudyNight": (60.0, -90.0),
    "SoftRainNight": (60.0, -90.0),
    "MidRainyNight": (80.0, -90.0),
    "HardRainNight": (100.0, -90.0),
    "DustStorm": (100.0, 45.0),
    "Default": (-1.0, -1.0),
}
"""carla.WeatherParameters: cloudiness in %, altitude of the sun in degrees."""
WEATHER = {
    "cloudiness": 1.0,
    "precipitation": 2.0,
    "precipitation_deposits": 3.0,
    "wind_intensity": 4.0,
    "sun_azimuth_angle": 5.0,
    "sun_altitude_angle": 6.0,
    "fog_density": 7.0,
    "fog_distance": 8.0,
    "fog_falloff": 9.0,
    "wetness": 10.0,
    "scattering_intensity": 11.0,
    "mie_scattering_scale": 12.0,
    "rayleigh_scattering_scale": 13.0,
    "dust_storm": 14.0,
}


def weather() -> carla.WeatherParameters:
    """A weather of which every part has a value of its own."""
    return carla.WeatherParameters(**WEATHER)


def is_preset(name: str, cloudiness: float, sun_altitude: float) -> Call:
    """Return a row for one of the client's ready-made weathers."""

    def call(_: Stage) -> bool:
        found = getattr(carla.WeatherParameters, name)
        return (found.cloudiness, found.sun_altitude_angle) == (cloudiness, sun_altitude)

    return call


def settings() -> carla.WorldSettings:
    """Settings of which most are not the default."""
    return carla.WorldSettings(
        synchronous_mode=True, no_rendering_mode=True, fixed_delta_seconds=0.05, max_substeps=5, spectator_as_ego=False
    )


def timestamp() -> carla.Timestamp:
    """A moment."""
    return carla.Timestamp(7, 1.5, 0.25, 100.0)


def generation() -> carla.OpendriveGenerationParameters:
    """How a world is made of a text."""
    return carla.OpendriveGenerationParameters(1.0, 2.0, 3.0, 4.0, False, False, False)


def osm() -> carla.Osm2OdrSettings:
    """How an OpenStreetMap extract is converted."""
    found = carla.Osm2OdrSettings()
    found.default_lane_width = 3.25
    return found


def converted(_: Stage) -> bool:
    """Whether a street of an OpenStreetMap extract comes out as a road."""
    nodes = "".join(
        f'<node id="{number}" lat="{48.77 + number * 1e-3}" lon="11.42" version="1"/>' for number in (1, 2, 3)
    )
    way = '<way id="9" version="1"><nd ref="1"/><nd ref="2"/><nd ref="3"/><tag k="highway" v="residential"/></way>'
    text = f'<?xml version="1.0"?><osm version="0.6" generator="test">{nodes}{way}</osm>'
    return "<road" in carla.Osm2Odr.convert(text, osm())


CALLS: dict[str, Call] = {
    "WeatherParameters.__init__": lambda _: carla.WeatherParameters(wetness=5.0).cloudiness == 0.0,
    **fields("WeatherParameters", lambda _: weather(), **WEATHER),
    **comparisons("WeatherParameters", weather, carla.WeatherParameters),
    **{f"WeatherParameters.{name}": is_preset(name, *values) for name, values in PRESETS.items()},
    "WorldSettings.__init__": lambda _: carla.WorldSettings().fixed_delta_seconds is None,
    **fields(
        "WorldSettings",
        lambda _: settings(),
        synchronous_mode=True,
        no_rendering_mode=True,
        fixed_delta_seconds=0.05,
        substepping=True,
        max_substep_delta_time=0.01,
        max_substeps=5,
        max_culling_distance=0.0,
        deterministic_ragdolls=False,
        tile_stream_distance=3000.0,
        actor_active_distance=2000.0,
        spectator_as_ego=False,
    ),
    **comparisons("WorldSettings", settings, carla.WorldSettings),
    "Timestamp.__init__": lambda _: carla.Timestamp(frame=3).elapsed_seconds == 0.0,
    **fields(
        "Timestamp",
        lambda _: timestamp(),
        frame=7,
        elapsed_seconds=1.5,
        delta_seconds=0.25,
        platform_timestamp=100.0,
        frame_count=7,
    ),
    **comparisons("Timestamp", timestamp, carla.Timestamp),
    "OpendriveGenerationParameters.__init__": lambda _: carla.OpendriveGenerationParameters().vertex_distance == 2.0,
    **fields(
        "OpendriveGenerationParameters",
        lambda _: generation(),
        vertex_distance=1.0,
        max_road_length=2.0,
        wall_height=3.0,
        additional_width=4.0,
        smooth_junctions=False,
        enable_mesh_visibility=False,
        enable_pedestrian_navigation=False,
    ),
    "Osm2Odr.convert": converted,
    "Osm2OdrSettings.__init__": lambda _: carla.Osm2OdrSettings().center_map is True,
    "Osm2OdrSettings.__str__": lambda _: len(str(osm())) > 0,
    **fields(
        "Osm2OdrSettings",
        lambda _: osm(),
        use_offsets=False,
        offset_x=0.0,
        offset_y=0.0,
        default_lane_width=3.25,
        elevation_layer_height=0.0,
        center_map=True,
        proj_string=lambda text: text.startswith("+proj"),
        generate_traffic_lights=True,
        all_junctions_with_traffic_lights=False,
    ),
    "Osm2OdrSettings.set_osm_way_types": lambda _: osm().set_osm_way_types(["residential"]),
    "Osm2OdrSettings.set_traffic_light_excluded_way_types": lambda _: osm().set_traffic_light_excluded_way_types(
        ["service"]
    ),
}
