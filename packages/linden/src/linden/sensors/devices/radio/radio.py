"""One radio over time: what it sends in a frame, and what it has received and not handed over yet."""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Generic, NamedTuple, TypeVar

import numpy as np

from linden.errors import Refusal
from linden.geometry import rotation_matrix
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.space import Transform, Vector3D
from linden.protocol.values.v2x import (
    LONGEST_TEXT_BYTES,
    CooperativeAwarenessMessage,
    CustomMessage,
    ReceivedCam,
    ReceivedText,
    StationType,
)
from linden.sensors.devices.attributes import Schedule, interval_s
from linden.sensors.devices.imu import compass_rad
from linden.sensors.devices.radio.awareness import Place, Telling, awareness, vehicle_facts
from linden.sensors.devices.radio.generation import Generation, StationMotion, generate
from linden.sensors.devices.radio.obstruction import Antenna
from linden.sensors.devices.radio.spec import cam_spec, channel_spec
from linden.simulation.actor_table import ActorRecord
from linden.simulation.episode import Episode

MOST_TEXTS = 1000
"""That one radio sends in a frame."""

Message = TypeVar("Message")
Received = TypeVar("Received")


class CamReading(NamedTuple):
    """What ``sensor.other.v2x`` hands over."""

    received: Sequence[ReceivedCam]


class TextReading(NamedTuple):
    """What ``sensor.other.v2x_custom`` hands over."""

    received: Sequence[ReceivedText]


class Station(NamedTuple):
    """What carries a radio, in one frame."""

    kind: StationType
    antenna: Antenna  # its actor is the carrier; of a road side unit what it is attached to, or the sensor itself
    carrier: ActorRecord | None  # a vehicle or walker


class Radio(ABC, Generic[Message, Received]):
    """A radio between two frames.

    Attributes:
        channel: how it sends and receives.
        number: of this radio among those of its episode, which its fading depends on.
        sendings: in how many frames it has sent.
        schedule: when it hands over what it has received.
        inbox: what it has received since.
    """

    def __init__(self, description: ActorDescription, number: int) -> None:
        self.channel = channel_spec(description)
        self.number = number
        self.sendings = 0
        self.schedule = Schedule(interval_s(description))
        self.inbox: list[Received] = []

    @abstractmethod
    def messages(self, episode: Episode, station: Station, *, speaks: bool) -> Sequence[Message]:
        """Return what it sends in this frame; to be called once in every frame.

        ``speaks``: whether it is the first radio of its kind on its carrier.
        """

    @abstractmethod
    def receive(self, power_dbm: float, message: Message) -> None:
        """Keep a message that has reached it."""

    @abstractmethod
    def hand_over(self) -> object:
        """Return what it has received as a reading, and forget it."""


class CamRadio(Radio[CooperativeAwarenessMessage, ReceivedCam]):
    """``sensor.other.v2x``: tells what its carrier does, without being asked."""

    def __init__(self, description: ActorDescription, number: int) -> None:
        super().__init__(description, number)
        self._spec = cam_spec(description)
        self._generation = Generation()

    def messages(self, episode: Episode, station: Station, *, speaks: bool) -> Sequence[CooperativeAwarenessMessage]:
        """Return the message that the generation rules ask for, of the first radio of a carrier."""
        if not speaks:
            return ()
        telling = None if station.carrier is None else _telling(episode, station.carrier)
        location = station.antenna.location._replace(z=station.antenna.ground_m)
        motion = None if telling is None else StationMotion(location, telling.heading_deg, telling.speed_mps)
        number = self._generation.made
        due, self._generation = generate(self._generation, self._spec, motion, episode.elapsed_s)
        if not due.message:
            return ()
        facts = vehicle_facts(station.carrier, station.kind) if due.facts and station.carrier is not None else None
        place = Place(
            station.antenna.actor_id,
            station.kind,
            episode.elapsed_s,
            station.antenna.location if station.carrier is None else location,
            episode.map.geo_origin_deg,
        )
        return (awareness(place, telling, facts, self._spec.errors, number),)

    def receive(self, power_dbm: float, message: CooperativeAwarenessMessage) -> None:
        """Keep a message that has reached it."""
        self.inbox.append(ReceivedCam(power_dbm, message))

    def hand_over(self) -> CamReading:
        """Return what it has received, and forget it."""
        received, self.inbox = self.inbox, []
        return CamReading(received)


class TextRadio(Radio[CustomMessage, ReceivedText]):
    """``sensor.other.v2x_custom``: sends what a script tells it to."""

    def __init__(self, description: ActorDescription, number: int) -> None:
        super().__init__(description, number)
        self._texts: list[str] = []

    def say(self, text: str) -> None:
        """Send a text in the next frame.

        Raises:
            Refusal: the text does not fit CARLA's record, or there are too many.
        """
        size = len(text.encode())
        if size > LONGEST_TEXT_BYTES or "\0" in text:
            raise Refusal(
                f"a custom message has at most {LONGEST_TEXT_BYTES} bytes of UTF-8, none of them 0; this one has "
                f"{size}: send it in parts"
            )
        if len(self._texts) >= MOST_TEXTS:
            raise Refusal(f"a radio sends at most {MOST_TEXTS} messages in a frame; tick the world before the next")
        self._texts.append(text)

    def messages(self, episode: Episode, station: Station, *, speaks: bool) -> Sequence[CustomMessage]:  # noqa: ARG002 - each radio of a carrier has texts of its own
        """Return the texts of this frame."""
        texts, self._texts = self._texts, []
        return [CustomMessage(station.antenna.actor_id, text) for text in texts]

    def receive(self, power_dbm: float, message: CustomMessage) -> None:
        """Keep a message that has reached it."""
        self.inbox.append(ReceivedText(power_dbm, message))

    def hand_over(self) -> TextReading:
        """Return what it has received, and forget it."""
        received, self.inbox = self.inbox, []
        return TextReading(received)


RADIOS: dict[str, type[CamRadio] | type[TextRadio]] = {
    "sensor.other.v2x": CamRadio,
    "sensor.other.v2x_custom": TextRadio,
}
"""The class of each radio by its blueprint."""


def _telling(episode: Episode, carrier: ActorRecord) -> Telling:
    bodies, slot = episode.bodies, carrier.slot
    pose: Transform = bodies.pose(slot)
    axes = rotation_matrix(pose.rotation)
    forwards, right, upwards = map(float, bodies.acceleration[slot] @ axes)
    return Telling(
        heading_deg=math.degrees(compass_rad(float(axes[0, 0]), float(axes[1, 0]))),
        speed_mps=float(np.dot(bodies.velocity[slot], axes[:, 0])),
        acceleration_mps2=Vector3D(forwards, right, upwards),
        yaw_rate_radps=float(bodies.angular_velocity[slot, 2]),
        length_m=2.0 * carrier.box.extent.x,
        width_m=2.0 * carrier.box.extent.y,
        brakes=bool(bodies.brake[slot] > 0.0),
        accelerates=bool(bodies.throttle[slot] > 0.0),
    )
