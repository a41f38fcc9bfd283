"""One GNSS receiver or inertial unit over time: its attributes, its memory, its reading in a frame."""

from typing import NamedTuple, TypeAlias

from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.space import GeoLocation, Transform, Vector3D
from linden.sensors.devices import gnss, imu
from linden.sensors.devices.attributes import GnssSpec, ImuSpec, Schedule, advance, gnss_spec, imu_spec, interval_s
from linden.sensors.devices.imu import ImuMeasurement, Trace

Reading: TypeAlias = GeoLocation | ImuMeasurement


class Moment(NamedTuple):
    """What a frame offers to an instrument."""

    now_s: float
    """Simulated time since the episode began."""
    pose: Transform
    """Of the instrument, in the world."""
    angular_velocity_radps: Vector3D
    """Of what carries it, in the world."""
    origin_deg: tuple[float, float]
    """Latitude and longitude of the map's origin."""
    gravity_mps2: float


class Instrument(NamedTuple):
    """An instrument between two frames."""

    spec: GnssSpec | ImuSpec
    schedule: Schedule
    trace: Trace = Trace()


def instrument(description: ActorDescription) -> Instrument | None:
    """Return the instrument that a complete description asks for, None where it is another kind of actor."""
    schedule = Schedule(interval_s(description))
    if description.id == "sensor.other.gnss":
        return Instrument(gnss_spec(description), schedule)
    if description.id == "sensor.other.imu":
        return Instrument(imu_spec(description), schedule)
    return None


def observe(instrument: Instrument, moment: Moment, *, wanted: bool = True) -> tuple[Reading | None, Instrument]:
    """Return the reading, None in a frame that is not the instrument's, and the instrument after the frame.

    To be called every frame, in order. ``wanted`` False, without subscribers, saves work and changes no later reading.
    """
    due, schedule = advance(instrument.schedule, moment.now_s)
    if not due:
        return None, instrument
    number, spec, location = instrument.schedule.made, instrument.spec, moment.pose.location
    if isinstance(spec, GnssSpec):
        reading = gnss.measure(spec, number, location, moment.origin_deg) if wanted else None
        return reading, instrument._replace(schedule=schedule)
    after = Instrument(spec, schedule, imu.extend(instrument.trace, location, moment.now_s))
    if not wanted:
        return None, after
    accelerated = imu.acceleration(instrument.trace, location, moment.now_s)
    turning, gravity = moment.angular_velocity_radps, moment.gravity_mps2
    return imu.measure(spec, number, moment.pose, accelerated, turning, gravity), after
