"""ROS 1 by rospy in a process of its own: a node with the same methods as that of ROS 2.

rospy belongs to the system's Python, so ``rospy_process.py`` runs there. Bytes of messages go to it and come from it
through pipes; a point cloud is copied once more than in a process of our own.
"""

from __future__ import annotations

import contextlib
import json
import subprocess
import threading
import time
from collections import deque
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.errors import UserError
from basu_ros.rospy_process import (
    ANNOUNCE,
    ANSWER,
    ENDED,
    HEAD,
    LISTEN,
    MASTER,
    MESSAGE,
    PEERS,
    PUBLISH,
    READY,
    VERSION,
    WARNING,
)
from basu_ros.rospy_start import master_uri, refusal, started
from linden_ros2.types import Generation, Types, types_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import IO

    from linden_ros2.topic import Message, Topic

START_S, CLOSE_S, ANSWER_S = 30.0, 5.0, 10.0
MD5_BYTES = 32
ANY = "*"  # rospy's MD5 sum for any version of a type


class Peer(NamedTuple):
    """A node on the other side of a topic: its name, and the definition of the type that it has."""

    name: str
    definition: str


class Ros1Node:
    """A node of ROS 1 at the master of ``ROS_MASTER_URI``."""

    kind, settings, missed_s = "ROS 1", "ROS_MASTER_URI", 1.0

    def __init__(self, name: str, *, in_lockstep: bool = False) -> None:
        """Start the node ``name``.

        ``in_lockstep``: nodes that start later take their time from ``/clock``, and every topic is latched. A frame
        waits for its answer, so a node that connects late must not miss it.

        Raises:
            UserError: rospy is not installed, no roscore answers, or a node of this name is there.
        """
        self.types = types_of(Generation.ROS_1)
        self.name = name
        self.realm = f"the master {master_uri()}"
        self.warnings: deque[str] = deque(maxlen=5)
        self._changed = threading.Condition()
        self._numbers: dict[str, int] = {}
        self._topics: list[Topic] = []
        self._arrived: dict[int, deque[bytes]] = {}
        self._peers: dict[int, list[Peer]] = {}
        self._definitions: dict[str, str] = {}  # of the versions that messages had, by MD5 sum
        self._state: tuple[bytes, dict[str, Any]] | None = None
        self._answers: deque[dict[str, Any]] = deque(maxlen=1)
        self._is_latched = in_lockstep
        self._process = started([name, "sim" if in_lockstep else "wall"])
        self._reader = threading.Thread(target=self._read, name="basu-ros1", daemon=True)
        self._reader.start()
        self._await_start()

    def announce(self, *topics: Topic) -> None:
        """Make publishers, so that peers find the topics before the first message."""
        self.announce_as(self.types, *topics)

    def announce_as(self, types: Types, *topics: Topic) -> None:
        """Make publishers of types in the versions of ``types``."""
        for topic in topics:
            if topic.name not in self._numbers:
                self._open(ANNOUNCE, topic, _definition(types, topic.type))

    def listen(self, *topics: Topic, any_version: bool = False) -> None:
        """Make subscribers; with ``any_version`` of topics with other fields in other versions of their type."""
        for topic in topics:
            if topic.name not in self._numbers:
                self._arrived[len(self._topics)] = deque(maxlen=topic.depth)
                text, md5 = _definition(self.types, topic.type)
                self._open(LISTEN, topic, (text, ANY if any_version else md5))

    def publish(self, *messages: Message) -> None:
        """Publish messages on their topics.

        Raises:
            UserError: the node was shut down.
        """
        self.publish_as(self.types, *messages)

    def publish_as(self, types: Types, *messages: Message) -> None:
        """Publish messages of types in the versions of ``types``."""
        for topic, content in messages:
            self.announce_as(types, topic)
            self._send(PUBLISH, types.data(content), self._numbers[topic.name])

    def received(self, topic: Topic) -> list[Any]:
        """Return the messages that have arrived since the last call, the oldest first, in the version of each peer.

        Raises:
            UserError: the node was shut down.
        """
        self._check_alive()
        number = self._numbers[topic.name]
        with self._changed:
            data = list(self._arrived[number])
            self._arrived[number].clear()
        found = []
        for each in data:
            md5 = each[:MD5_BYTES].decode()
            types = self._types_of(topic.type, md5)
            found.append(types.parsed(each[MD5_BYTES:], topic.type))
        return found

    def wait(self, topic: Topic, timeout_s: float) -> bool:
        """Wait until something has arrived on a topic; whether it has."""
        return self.wait_any([topic], timeout_s)

    def wait_any(self, topics: Sequence[Topic], timeout_s: float) -> bool:
        """Wait until something has arrived on one of the topics; whether it has.

        Raises:
            UserError: the node was shut down.
        """
        numbers = [self._numbers[topic.name] for topic in topics]
        with self._changed:
            found = self._changed.wait_for(
                lambda: self._has_ended or any(self._arrived[number] for number in numbers), timeout_s
            )
        self._check_alive()
        return found

    def writers_of(self, topic: Topic) -> int:
        """Return how many peers publish on a topic that this node listens to."""
        return len(self.peers_of(topic))

    def unheard(self, topic: Topic) -> list[str]:
        """Return what rospy said of peers with another version of a topic's type."""
        return [f"that rospy refused: {text}" for text in list(self.warnings) if topic.name in text]

    def readers_of(self, topic: Topic) -> int:
        """Return how many peers listen to a topic of this node."""
        self.announce(topic)
        return len(self.peers_of(topic))

    def peers_of(self, topic: Topic) -> list[Peer]:
        """Return the peers of a topic."""
        with self._changed:
            return list(self._peers.get(self._numbers[topic.name], []))

    def wait_for_peers(self, topic: Topic, timeout_s: float) -> bool:
        """Wait until an announced topic has a reader, or one that is listened to a writer; whether it has."""
        number = self._numbers[topic.name]
        with self._changed:
            return self._changed.wait_for(lambda: bool(self._peers.get(number)), timeout_s)

    def publishers_of(self, name: str) -> list[str]:
        """Return the names of the nodes that publish on any topic, as the master knows them; one may have died.

        Raises:
            UserError: the master does not answer any more.
        """
        self._answers.clear()
        self._send(MASTER, name.encode())
        with self._changed:
            self._changed.wait_for(lambda: bool(self._answers) or self._has_ended, ANSWER_S)
            answer = self._answers[-1] if self._answers else {"nodes": None}
        if answer["nodes"] is None:
            raise UserError(f"{self.realm} does not answer any more; was roscore ended?")
        return [node for node in answer["nodes"] if node != f"/{self.name}"]

    def close(self) -> None:
        """End the node; its process leaves the master by itself."""
        if self._process.stdin is not None:
            with contextlib.suppress(OSError, ValueError):
                self._process.stdin.close()
        try:
            self._process.wait(CLOSE_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._reader.join(CLOSE_S)
        if self._process.stdout is not None:
            self._process.stdout.close()

    @property
    def pid(self) -> int:
        """The number of rospy's process."""
        return self._process.pid

    @property
    def _has_ended(self) -> bool:
        """Whether the node is there no more."""
        return self._state is not None and self._state[0] != READY

    def _open(self, kind: bytes, topic: Topic, version: tuple[str, str]) -> None:
        """Give a topic a number and let rospy open it."""
        number = self._numbers[topic.name] = len(self._topics)
        self._topics.append(topic)
        definition, md5 = version
        wanted = {
            "name": topic.name,
            "type": topic.type.replace("/msg/", "/"),
            "md5": md5,
            "definition": definition,
            "latched": topic.is_latched or self._is_latched,
            "depth": topic.depth,
        }
        self._send(kind, json.dumps(wanted).encode(), number)

    def _types_of(self, name: str, md5: str) -> Types:
        """The types that a peer has: ours, or those of the definition that came before its first message."""
        if _definition(self.types, name)[1] == md5:
            return self.types
        return _foreign_types(name, self._definitions[md5])

    def _send(self, kind: bytes, content: bytes | memoryview, number: int = 0) -> None:
        """Write a frame to rospy's process."""
        self._check_alive()
        assert self._process.stdin is not None, "it has a pipe"
        try:
            self._process.stdin.write(HEAD.pack(kind, number, len(content)))
            self._process.stdin.write(content)
            self._process.stdin.flush()
        except OSError:
            with self._changed:  # the reader is about to see the end
                self._changed.wait_for(lambda: self._has_ended, CLOSE_S)
            self._check_alive()
            raise

    def _check_alive(self) -> None:
        """Check that the node is there.

        Raises:
            UserError: it is not.
        """
        if self._has_ended:
            assert self._state is not None, "it has ended"
            raise UserError(
                f"the ROS 1 node /{self.name} ended: {self._state[1].get('reason', 'its process died')}; "
                "a node of the same name, or rosnode kill, ends it"
            )

    def _read(self) -> None:
        """Take in what rospy's process writes; runs in a thread."""
        stream: IO[bytes] | None = self._process.stdout
        assert stream is not None, "it has a pipe"
        while True:
            head = stream.read(HEAD.size)
            if len(head) < HEAD.size:
                break
            kind, number, size = HEAD.unpack(head)
            content = stream.read(size)
            with self._changed:
                self._take(kind, number, content)
                self._changed.notify_all()
        with self._changed:
            if not self._has_ended:
                self._state = (ENDED, {})
            self._changed.notify_all()

    def _take(self, kind: bytes, number: int, content: bytes) -> None:
        """Take in a frame."""
        if kind == MESSAGE:
            self._arrived[number].append(content)
        elif kind == VERSION:
            md5, definition = json.loads(content)
            self._definitions[md5] = definition
        elif kind == PEERS:
            self._peers[number] = [Peer(*each) for each in json.loads(content)]
        elif kind == ANSWER:
            self._answers.append(json.loads(content))
        elif kind == WARNING:
            self.warnings.append(content.decode())
        else:
            self._state = (kind, json.loads(content))

    def _await_start(self) -> None:
        """Wait until the node is at the master.

        Raises:
            UserError: it is refused.
        """
        until_s = time.monotonic() + START_S
        with self._changed:
            self._changed.wait_for(lambda: self._state is not None, until_s - time.monotonic())
            state = self._state
        if state is not None and state[0] == READY:
            return
        self.close()
        if state is None:
            raise UserError(f"rospy did not start within {START_S:g} s; see whether {self.realm} answers")
        raise refusal(state, self.realm)


def require_roscore() -> None:
    """Check that ROS 1 is there and a roscore answers.

    Raises:
        UserError: it is not, or none does.
    """
    Ros1Node("basu_look").close()


@cache
def _definition(types: Types, name: str) -> tuple[str, str]:
    """The definition of a type with all that it holds, and its MD5 sum."""
    text, md5 = types.store.generate_msgdef(name, ros_version=1)
    return text, md5


@cache
def _foreign_types(name: str, definition: str) -> Types:
    """The types of a peer that has another version of ``name``."""
    return Types(Generation.ROS_1, {name: definition})
