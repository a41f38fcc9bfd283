"""Reading of weather, vehicle physics and world settings as named numbers, to detect changes made by an agent.

Each is named as in a sentence. Each function is one call to the server.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.routing.weather import WEATHER_FIELDS

if TYPE_CHECKING:
    from basu.managers.base_manager import Run

PHYSICS = ("mass", "max_rpm", "moi", "drag_coefficient", "final_ratio", "use_gear_autobox")
WHEEL = ("max_steer_angle", "radius", "max_brake_torque", "max_handbrake_torque")


def every_value(run: Run) -> dict[str, float]:
    """Return all of them."""
    return {**weather_values(run), **physics_values(run), **settings_values(run)}


def weather_values(run: Run) -> dict[str, float]:
    """Return the weather."""
    weather = run.world.get_weather()
    return {f"the weather's {name}": float(getattr(weather, name)) for name in WEATHER_FIELDS}


def physics_values(run: Run) -> dict[str, float]:
    """Return the vehicle's physics."""
    physics = run.vehicle.get_physics_control()
    values = {f"the vehicle's {name}": float(getattr(physics, name)) for name in PHYSICS}
    for index, wheel in enumerate(physics.wheels):
        values |= {f"the vehicle's wheel {index} {name}": float(getattr(wheel, name)) for name in WHEEL}
        values[f"the vehicle's wheel {index} tire_friction"] = float(wheel.tire_friction)
    values["the vehicle's torque"] = sum(float(point.y) for point in physics.torque_curve)
    values["the vehicle's gear ratios"] = sum(float(gear.ratio) for gear in physics.forward_gears)
    return values


def settings_values(run: Run) -> dict[str, float]:
    """Return the world's settings."""
    settings = run.world.get_settings()
    return {
        "the world's synchronous mode": float(settings.synchronous_mode),
        "the world's time step": float(settings.fixed_delta_seconds or 0.0),
        "the world's rendering": float(not settings.no_rendering_mode),
    }
