"""`Gate`: one agent's session. It says which calls pass, rewrites answers, and filters the world's snapshots.

Answers are rewritten for two reasons. A token has to name the gate's port instead of the server's. And the descriptions
of actors show which stream belongs to which sensor, and are hidden in tracks that hide the actors themselves.
"""

import struct
from collections import Counter
from collections.abc import Callable, Collection, Iterable
from typing import Any

import msgpack

from linden.errors import ProtocolError
from linden.gate.calls import CALLS, COMMANDS, UNKNOWN, Entry, Rule, Track, sentence
from linden.protocol.wire.answers import RESPONSE, Call, refusal, unknown
from linden.protocol.wire.client_functions import CARLA_FUNCTIONS
from linden.protocol.wire.stream import WORLD_OBSERVER_ID, Endpoint, read_token, token_bytes

_FRAME_AT = 8  # in a message: after the index of the sensor's type
_HEADERS_BYTES = 48 + 36  # of a sensor's message, of the episode
_ROW_BYTES = 119
_FRAME, _ID = struct.Struct("<Q"), struct.Struct("<I")
_DESCRIPTION, _TOKEN, _ATTRIBUTES = 2, 5, 2  # among the fields of an actor, of its description
_ROLE = "role_name"
_OTHERS = "others"
"""Under which refused names are counted that CARLA does not have: an agent may make up any number of them."""

_pack = msgpack.Packer(unicode_errors="surrogateescape").pack


class Gate:
    """What one agent may do and see.

    Attributes:
        agent: the process that may connect, as may all that it started; None: any process.
        refused: how often each function was refused.
        endpoints: where the server says that the streams are which the agent has asked for.
    """

    def __init__(
        self,
        track: Track,
        vehicle_id: int,
        streaming_port: int,
        *,
        sensors: Iterable[int] = (),
        known: Iterable[int] = (),
        agent: int | None = None,
    ) -> None:
        """Open a session for the driver of ``vehicle_id``.

        It subscribes to streams at ``streaming_port``. Its sensors may come later. ``known`` are actors that it sees in
        each frame of the track ``objects``: lights and signs. ``agent`` is its process; None: any process.
        """
        self.track = track
        self.agent = agent
        self._vehicle_id = vehicle_id
        self._port = streaming_port
        self._sensors = set(sensors)
        self._known = frozenset(known)
        self._visible: frozenset[int] = frozenset()
        self._visible_in: int | None = None  # the frame that ``_visible`` belongs to
        self._streams: dict[int, int] = {}  # of sensors, by the actor's id
        self.endpoints: dict[int, Endpoint] = {}
        self.refused: Counter[str] = Counter()

    # -- what the benchmark says

    def add_sensors(self, ids: Iterable[int]) -> None:
        """Let the agent hear sensors that were spawned for it."""
        self._sensors |= set(ids)

    def see(self, frame: int, ids: Iterable[int]) -> None:
        """Note which actors the agent sees in a frame, in the track ``objects``."""
        self._visible_in, self._visible = frame, frozenset(ids)

    # -- calls

    def refuse(self, call: Call) -> bytes | None:
        """Return the answer to a call that is refused, and count it; None where it may pass."""
        entry = CALLS.get(call.method, UNKNOWN)
        why = self._why(entry, call.args)
        if why is None:
            return None
        self.refused[call.method if call.method in CALLS else _OTHERS] += 1
        text = sentence(call.method, why)
        if call.method == "apply_batch":
            return self._refused_batch(call)
        reply = CARLA_FUNCTIONS.get(call.method)
        return unknown(call, text) if reply is None else refusal(call, text, reply)

    def rewrites(self, method: str) -> bool:
        """Return whether the answer to a call has to go through :meth:`rewritten`."""
        return method in _REWRITTEN

    def rewritten(self, call: Call, answer: bytes) -> bytes:
        """Return the answer that the agent gets in place of the server's; an error goes through as it is.

        Raises:
            ProtocolError: the server's answer is not as CARLA's.
        """
        message: Any = msgpack.unpackb(answer, unicode_errors="surrogateescape", strict_map_key=False)
        try:
            is_value, result = message[3][0][0], message[3][0][1:]
            if message[2] is not None or is_value != 1:
                return answer
            value = _REWRITTEN[call.method](self, result[0])
        except (LookupError, TypeError, ValueError) as error:
            raise ProtocolError(f"the server's answer to {call.method} is not as CARLA's: {error}") from error
        rewritten: bytes = _pack((RESPONSE, call.id, None, ((1, value),)))
        return rewritten

    # -- streams

    def may_hear(self, stream_id: int) -> bool:
        """Return whether the agent may subscribe to a stream."""
        return stream_id == WORLD_OBSERVER_ID or any(self._streams.get(sensor) == stream_id for sensor in self._sensors)

    @property
    def filters(self) -> bool:
        """Whether world snapshots have to go through :meth:`shown`."""
        return self.track is not Track.WORLD

    def shown(self, payload: bytes) -> bytes | None:
        """Return a world snapshot with the actors that the agent sees; None while that frame waits for :meth:`see`."""
        if self.track is Track.WORLD:
            return payload
        if self.track is Track.OBJECTS and self._visible_in != _FRAME.unpack_from(payload, _FRAME_AT)[0]:
            return None
        sees = self._sees
        rows = range(_HEADERS_BYTES, len(payload) - _ROW_BYTES + 1, _ROW_BYTES)
        kept = [payload[at : at + _ROW_BYTES] for at in rows if sees(_ID.unpack_from(payload, at)[0])]
        return b"".join((payload[:_HEADERS_BYTES], *kept))

    # -- rules

    def _why(self, entry: Entry, args: list[Any]) -> str | None:
        """Return why a call is refused, None where it is not."""
        rule = entry.rule
        if rule is Rule.READ or rule is Rule.ACTORS:
            return None
        if rule is Rule.READ_WORLD:
            return None if self.track is Track.WORLD else entry.why
        if rule is Rule.BATCH:
            return None if self._first_refused(args) is None else entry.why
        if rule is Rule.REFUSED or not args or type(args[0]) is not int:
            return entry.why or "its arguments are not as CARLA's client sends them"
        allowed = {
            Rule.READ_ACTOR: self._may_read,
            Rule.LISTEN: self.may_hear,
            Rule.OWN_SENSOR: self._sensors.__contains__,
            Rule.OWN_VEHICLE: self._vehicle_id.__eq__,
        }
        return None if allowed[rule](args[0]) else entry.why

    def _may_read(self, actor_id: int) -> bool:
        return self.track is Track.WORLD or actor_id in self._sensors or self._sees(actor_id)

    def _sees(self, actor_id: int) -> bool:
        """Return whether a snapshot shows an actor, in a track that hides some."""
        if actor_id == self._vehicle_id:
            return True
        return self.track is Track.OBJECTS and (actor_id in self._visible or actor_id in self._known)

    def _first_refused(self, args: list[Any]) -> Entry | None:
        """Return the entry of the first command of a batch that is not allowed, None where all are."""
        if len(args) != 2 or args[1] is not False or not _is_list(args[0]):  # its own tick is the benchmark's
            return CALLS["tick_cue"]
        for command in args[0]:
            entry = _entry_of(command)
            body = command[0][1] if entry is not UNKNOWN else []
            if self._why(entry, body) is not None:
                return entry
        return None

    def _refused_batch(self, call: Call) -> bytes:
        """Return an answer in which each command of a batch has failed."""
        found = self._first_refused(call.args)
        why = UNKNOWN.why if found is None else found.why
        failed = ((0, (sentence("apply_batch", f"{why}; none of its commands is carried out"),)),)
        commands = call.args[0] if call.args and _is_list(call.args[0]) else ()
        answer: bytes = _pack((RESPONSE, call.id, None, (failed,) * len(commands)))
        return answer

    # -- answers

    def _episode(self, value: Any) -> Any:  # noqa: ANN401 - as msgpack has it
        return [value[0], [self._own_token(value[1][0])]]

    def _token(self, value: Any) -> Any:  # noqa: ANN401 - as msgpack has it
        return [self._own_token(value[0])]

    def _own_token(self, data: bytes) -> bytes:
        endpoint = read_token(data)
        self.endpoints[endpoint.stream_id] = endpoint
        return token_bytes(endpoint.stream_id, self._port)

    def _actors(self, actors: Any) -> Any:  # noqa: ANN401 - as msgpack has it
        """Return the descriptions of actors that the agent sees, and learn the streams of sensors."""
        for actor in actors:
            if len(actor) > _TOKEN and actor[_TOKEN]:
                self._streams[actor[0]] = read_token(actor[_TOKEN]).stream_id
        if self.track is Track.WORLD:
            return actors
        seen = [actor for actor in actors if self._may_read(actor[0])]
        for actor in seen:
            if actor[0] != self._vehicle_id:
                _without_role(actor[_DESCRIPTION][_ATTRIBUTES])
        return seen


_REWRITTEN: dict[str, Callable[[Gate, Any], Any]] = {
    "get_episode_info": Gate._episode,  # noqa: SLF001 - the table of this class
    "get_sensor_token": Gate._token,  # noqa: SLF001 - likewise
    "get_actors_by_id": Gate._actors,  # noqa: SLF001 - likewise
}


def _entry_of(command: Any) -> Entry:  # noqa: ANN401 - whatever msgpack found
    """Return the entry of a command of a batch."""
    if not (_is_list(command) and len(command) == 1 and _is_list(command[0]) and len(command[0]) == 2):
        return UNKNOWN
    index, body = command[0]
    if type(index) is not int or index not in COMMANDS or not _is_list(body):
        return UNKNOWN
    return CALLS[COMMANDS[index]]


def _is_list(value: object) -> bool:
    return type(value) is list


def _without_role(attributes: Collection[list[Any]]) -> None:
    """Take the role out of an actor's attributes: it may say which part of which scenario the actor has."""
    for attribute in attributes:
        if attribute[0] == _ROLE:
            attribute[2] = ""
