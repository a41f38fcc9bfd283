"""The radios of an episode, and the way of their messages from one to the others in each frame."""

from collections.abc import Container, Iterator, Sequence
from typing import NamedTuple

from linden.blueprints.library import BlueprintKind
from linden.errors import Refusal
from linden.maps.ground import surface_under
from linden.protocol.values.space import Transform
from linden.sensors.devices.attributes import advance
from linden.sensors.devices.noise import dice_of
from linden.sensors.devices.radio.awareness import station_type
from linden.sensors.devices.radio.obstruction import Antenna, Link, paths, roof_m
from linden.sensors.devices.radio.path_loss import fading_db, path_loss_db
from linden.sensors.devices.radio.radio import RADIOS, CamRadio, Station, TextRadio
from linden.sensors.runtime.looking_sensors import SensorFrame
from linden.simulation.actor_table import ActorRecord
from linden.simulation.episode import Episode

ABOVE_ROOF_M = 0.02
"""How high an antenna stands above its carrier, wherever on it the sensor is (CARLA 0.9.16, PathLossModel.cpp)."""

AnyRadio = CamRadio | TextRadio


class _Sending(NamedTuple):
    """What one radio sends in a frame."""

    radio: AnyRadio
    antenna: Antenna
    messages: Sequence[object]


class RadioNetwork:
    """The radios of one episode, oldest first. Those of one kind hear each other."""

    def __init__(self) -> None:
        self._radios: dict[int, AnyRadio] = {}
        self._numbered = 0

    def __contains__(self, actor_id: int) -> bool:
        return actor_id in self._radios

    def __iter__(self) -> Iterator[int]:
        return iter(self._radios)

    def add(self, record: ActorRecord) -> None:
        """Make the radio of an actor that was spawned, if the actor is one.

        Raises:
            Refusal: the attributes contradict each other.
        """
        if (kind := RADIOS.get(record.description.id)) is not None:
            self._radios[record.id] = kind(record.description, self._numbered)
            self._numbered += 1

    def remove(self, actor_id: int) -> None:
        """Drop the radio of an actor that is destroyed."""
        self._radios.pop(actor_id, None)

    def say(self, actor_id: int, text: str) -> None:
        """Let a radio send a text in the next frame.

        Raises:
            Refusal: the actor is no radio for texts, or the text does not fit.
        """
        radio = self._radios.get(actor_id)
        if not isinstance(radio, TextRadio):
            raise Refusal(f"actor {actor_id} cannot send a text; only sensor.other.v2x_custom does")
        radio.say(text)

    def exchange(
        self, episode: Episode, now: SensorFrame, listened: Container[int]
    ) -> list[tuple[ActorRecord, Transform, object]]:
        """Send what is to be sent in this frame; return what is handed over: sensor, its pose, reading.

        Messages are generated without listeners too, so that later messages do not depend on them. A radio with a
        ``sensor_tick`` hands over at every tick, without messages too, so that a client can wait for it.
        """
        records = [episode.actors.get(actor_id) for actor_id in self._radios]
        stations = [station_of(episode, record) for record in records]
        sendings = self._sendings(episode, stations)
        ears = [
            (radio, station)
            for radio, station, record in zip(self._radios.values(), stations, records, strict=True)
            if record.stream_id in listened
        ]
        _deliver(sendings, ears, episode, now)
        found: list[tuple[ActorRecord, Transform, object]] = []
        for radio, record in zip(self._radios.values(), records, strict=True):
            due, radio.schedule = advance(radio.schedule, episode.elapsed_s)
            if record.stream_id not in listened:
                radio.inbox.clear()
            elif due and (radio.inbox or radio.schedule.interval_s > 0.0):
                found.append((record, episode.actors.transform(record.id), radio.hand_over()))
        return found

    def _sendings(self, episode: Episode, stations: Sequence[Station]) -> list[_Sending]:
        sendings = []
        spoken: set[tuple[type, int]] = set()
        for radio, station in zip(self._radios.values(), stations, strict=True):
            mouth = type(radio), station.antenna.actor_id
            messages = radio.messages(episode, station, speaks=mouth not in spoken)
            spoken.add(mouth)
            if messages:
                sendings.append(_Sending(radio, station.antenna, messages))
                radio.sendings += 1
        return sendings


def station_of(episode: Episode, record: ActorRecord) -> Station:
    """Return what carries a radio, and where its antenna is."""
    carrier = episode.carrier(record)
    kind = station_type(carrier)
    if carrier is None or carrier.kind not in (BlueprintKind.VEHICLE, BlueprintKind.WALKER):
        location = episode.actors.transform(record.id).location
        ground_m = surface_under(episode.map.ground, location.x, location.y, location.z)[0]
        holder = carrier.id if carrier is not None else record.parent_id or record.id
        return Station(kind, Antenna(holder, location, min(ground_m, location.z)), None)
    location = episode.transform(carrier.id).location
    foot_m = location.z if carrier.kind is BlueprintKind.VEHICLE else location.z - carrier.box.extent.z
    antenna = location._replace(z=roof_m(carrier, location) + ABOVE_ROOF_M)
    return Station(kind, Antenna(carrier.id, antenna, foot_m), carrier)


def _deliver(
    sendings: Sequence[_Sending], ears: Sequence[tuple[AnyRadio, Station]], episode: Episode, now: SensorFrame
) -> None:
    """Put the messages into the inboxes of the radios that receive them."""
    pairs = [
        (sending, radio, link)
        for radio, station in ears
        for sending in sendings
        if type(sending.radio) is type(radio) and sending.antenna.actor_id != station.antenna.actor_id
        if (link := Link(sending.antenna, station.antenna)).distance_m < radio.channel.filter_distance_m
    ]
    if not pairs:
        return
    ways = paths(now.seen(episode), episode.actors, [link for _, _, link in pairs])
    for (sending, radio, _), path in zip(pairs, ways, strict=True):
        lost_db = path_loss_db(radio.channel, path) + _faded_db(
            sending.radio, radio, fading_db(radio.channel, path.state)
        )
        power_dbm = sending.radio.channel.transmit_power_dbm + radio.channel.antenna_gain_db - lost_db
        if power_dbm >= radio.channel.receiver_sensitivity_dbm:
            for message in sending.messages:
                radio.receive(power_dbm, message)  # type: ignore[arg-type] # both are of one kind


def _faded_db(sender: AnyRadio, receiver: AnyRadio, deviation_db: float) -> float:
    """Return the fading of one sending at one receiver: a draw of its own, which the receiver's seed decides."""
    if deviation_db == 0.0:
        return 0.0
    number = (receiver.number & 0xFFFF) << 48 | (sender.number & 0xFFFF) << 32 | sender.sendings & 0xFFFF_FFFF
    return deviation_db * float(dice_of(receiver.channel.seed, number).standard_normal())
