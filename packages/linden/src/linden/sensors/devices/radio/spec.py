"""Attributes of ``sensor.other.v2x`` and ``sensor.other.v2x_custom`` as numbers."""

from enum import Enum
from typing import NamedTuple

from linden.errors import Refusal
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.space import Vector3D
from linden.sensors.devices.attributes import GnssSpec, gnss_spec


class Scenario(Enum):
    """Surroundings for which the path loss was measured."""

    HIGHWAY = "highway"
    RURAL = "rural"
    URBAN = "urban"


class PathLossModel(Enum):
    """The two models of path loss of CARLA."""

    WINNER = "winner"
    GEOMETRIC = "geometric"


class ChannelSpec(NamedTuple):
    """What a radio sends with, and how it reckons what reaches it."""

    transmit_power_dbm: float = 21.5
    receiver_sensitivity_dbm: float = -99.0
    frequency_ghz: float = 5.9
    antenna_gain_db: float = 10.0  # of both antennas together
    scenario: Scenario = Scenario.HIGHWAY
    model: PathLossModel = PathLossModel.WINNER
    path_loss_exponent: float = 2.7
    reference_distance_m: float = 1.0
    filter_distance_m: float = 500.0
    etsi_fading: bool = True
    custom_fading_db: float = 0.0  # standard deviation
    seed: int = 0


class CamErrors(NamedTuple):
    """Errors of what a vehicle tells of itself; the yaw rate is that of CARLA's frame."""

    position: GnssSpec = GnssSpec()
    heading_bias_deg: float = 0.0
    heading_deviation_deg: float = 0.0
    speed_deviation_mps: float = 0.0
    acceleration_deviation_mps2: Vector3D = Vector3D()
    yaw_rate_bias_radps: float = 0.0
    yaw_rate_deviation_radps: float = 0.0


class CamSpec(NamedTuple):
    """When a vehicle tells of itself, and how wrongly."""

    least_interval_s: float = 0.1
    greatest_interval_s: float = 1.0
    fixed_rate: bool = False
    errors: CamErrors = CamErrors()


def channel_spec(description: ActorDescription) -> ChannelSpec:
    """Read a complete description of either sensor."""
    return ChannelSpec(
        transmit_power_dbm=description.number("transmit_power"),
        receiver_sensitivity_dbm=description.number("receiver_sensitivity"),
        frequency_ghz=description.number("frequency_ghz"),
        antenna_gain_db=description.number("combined_antenna_gain"),
        scenario=Scenario(description.attribute("scenario")),
        model=PathLossModel(description.attribute("path_loss_model")),
        path_loss_exponent=description.number("path_loss_exponent"),
        reference_distance_m=description.number("d_ref"),
        filter_distance_m=description.number("filter_distance"),
        etsi_fading=description.flag("use_etsi_fading"),
        custom_fading_db=description.number("custom_fading_stddev"),
        seed=int(description.attribute("noise_seed")),
    )


def cam_spec(description: ActorDescription) -> CamSpec:
    """Read a complete description of ``sensor.other.v2x``.

    Raises:
        Refusal: the least interval is longer than the greatest.
    """
    least_s, greatest_s = (description.number(f"gen_cam_{name}") for name in ("min", "max"))
    if least_s > greatest_s:
        raise Refusal(
            f"Spawn failed because of invalid actor description: messages cannot be {least_s:g} s apart at least and "
            f"{greatest_s:g} s at most; gen_cam_min must not be above gen_cam_max"
        )
    errors = CamErrors(
        position=gnss_spec(description),
        heading_bias_deg=description.number("noise_head_bias"),
        heading_deviation_deg=description.number("noise_head_stddev"),
        speed_deviation_mps=description.number("noise_vel_stddev_x"),
        acceleration_deviation_mps2=Vector3D(*(description.number(f"noise_accel_stddev_{axis}") for axis in "xyz")),
        yaw_rate_bias_radps=description.number("noise_yawrate_bias"),
        yaw_rate_deviation_radps=description.number("noise_yawrate_stddev"),
    )
    return CamSpec(least_s, greatest_s, description.flag("fixed_rate"), errors)
