"""A ROS 1 node for another process: topics by rospy, frames of bytes on standard input and output.

The system's Python runs this file, which may be another version than BASU's. It imports nothing of BASU. Messages are
bytes that BASU has made, so that no message package has to be installed. ``basu_ros.ros1`` is the other side.

A frame is a kind (one byte), the number of a topic (2 bytes), a length (4 bytes) and the content, little-endian.
Received messages begin with the MD5 sum of their type (32 bytes).
"""

# ruff: noqa: ANN401, PLC0415, SLF001, UP006, UP035, UP045 - rospy has no types and bytes are private there; Python 3.8

import json
import logging
import os
import socket
import struct
import sys
import threading
import time
import traceback
from typing import Any, BinaryIO, Dict, List, Optional, Set, Tuple
from xmlrpc.client import Error, ServerProxy

HEAD = struct.Struct("<cHI")
ANNOUNCE, LISTEN, PUBLISH, MASTER = b"A", b"L", b"P", b"Q"  # from BASU
READY, REFUSED, MESSAGE, PEERS, ANSWER, WARNING, ENDED = b"O", b"E", b"M", b"C", b"R", b"W", b"X"  # to BASU
VERSION = b"V"  # to BASU: MD5 sum and definition of a type, before the first message of this version
EVERY_S = 0.01  # between two looks at the connections; rospy has no event for those of a subscriber
PATIENCE_S = 5.0  # of the first question to the master
SIM_TIME = "/use_sim_time"


class Pipe:
    """Frames to BASU, from any thread."""

    def __init__(self, out: BinaryIO) -> None:
        """Write to ``out``."""
        self._out, self._lock = out, threading.Lock()

    def send(self, kind: bytes, content: bytes, topic: int = 0) -> None:
        """Write a frame; the end of the other side ends this process."""
        with self._lock:
            try:
                self._out.write(HEAD.pack(kind, topic, len(content)) + content)
                self._out.flush()
            except OSError:
                os._exit(0)

    def tell(self, kind: bytes, **values: Any) -> None:
        """Write a frame of JSON."""
        self.send(kind, json.dumps(values).encode())


class Warnings(logging.Handler):
    """Passes rospy's warnings on, such as a peer with another version of a type."""

    def __init__(self, pipe: Pipe) -> None:
        """Write to ``pipe``."""
        super().__init__(logging.WARNING)
        self._pipe = pipe

    def emit(self, record: logging.LogRecord) -> None:
        """Pass a record on."""
        self._pipe.send(WARNING, record.getMessage().encode(errors="replace"))


class Bridge:
    """The node: publishers and subscribers by the numbers that BASU gives them."""

    def __init__(self, rospy: Any, pipe: Pipe) -> None:
        """Use ``rospy`` after its ``init_node``."""
        self._rospy, self._pipe = rospy, pipe
        self._topics: Dict[int, Any] = {}
        self._classes: Dict[int, Any] = {}
        self._told: Dict[int, List[Tuple[str, ...]]] = {}
        self._versions: Set[str] = set()

    def announce(self, number: int, wanted: Dict[str, Any]) -> None:
        """Make a publisher. Its messages are bytes."""
        made = self._class_of(number, wanted)
        name, depth, latch = wanted["name"], wanted["depth"], wanted["latched"]
        self._topics[number] = self._rospy.Publisher(name, made, queue_size=depth, latch=latch, tcp_nodelay=True)

    def listen(self, number: int, wanted: Dict[str, Any]) -> None:
        """Make a subscriber. Without an MD5 sum it takes any version of its type."""
        made = self._class_of(number, wanted)
        self._topics[number] = self._rospy.Subscriber(
            wanted["name"], made, self._hear, callback_args=number, queue_size=wanted["depth"], tcp_nodelay=True
        )

    def publish(self, number: int, content: bytes) -> None:
        """Publish a message."""
        message = self._classes[number]()
        message._buff = content
        self._topics[number].publish(message)

    def watch(self) -> None:
        """Tell the connections of each topic whenever they change, until rospy shuts down."""
        while not self._rospy.is_shutdown():
            for number, topic in list(self._topics.items()):
                peers = [_peer(each) for each in list(topic.impl.connections or []) if each.socket is not None]
                if self._told.get(number, []) != peers:
                    self._told[number] = peers
                    self._pipe.send(PEERS, json.dumps(peers).encode(), number)
            time.sleep(EVERY_S)
        self._pipe.tell(ENDED, reason="the node was shut down")

    def _class_of(self, number: int, wanted: Dict[str, Any]) -> Any:
        """A message class that holds bytes."""
        body = {"_type": wanted["type"], "_md5sum": wanted["md5"], "_full_text": wanted["definition"], "__slots__": []}
        self._classes[number] = type("Bytes", (self._rospy.AnyMsg,), body)
        return self._classes[number]

    def _hear(self, message: Any, number: int) -> None:
        """Pass a message on."""
        header = message._connection_header
        md5 = header["md5sum"]
        if md5 not in self._versions:
            self._pipe.send(VERSION, json.dumps([md5, header.get("message_definition", "")]).encode(), number)
            self._versions.add(md5)
        self._pipe.send(MESSAGE, md5.encode() + message._buff, number)


def _peer(connection: Any) -> Tuple[str, ...]:
    """Name of a peer, and the definition of its type where it publishes."""
    header = getattr(connection, "header", None) or {"callerid": connection.endpoint_id}
    return tuple(str(header.get(key, "")) for key in ("callerid", "message_definition"))


def _read(stream: BinaryIO, count: int) -> Optional[bytes]:
    """Exactly ``count`` bytes, None at the end."""
    data = stream.read(count)
    return data if len(data) == count else None


def _start(name: str, sim_time: bool, pipe: Pipe) -> Any:  # noqa: FBT001 - of a protocol
    """Rospy with the node started, or None after a refusal was sent."""
    try:
        import rosgraph
        import rospy
        import rospy.impl.tcpros_pubsub as tcp
    except ImportError as error:
        pipe.tell(REFUSED, why="import", text=str(error))
        return None
    master = rosgraph.Master("/" + name)
    socket.setdefaulttimeout(PATIENCE_S)
    try:
        master.getPid()
    except (OSError, ValueError, rosgraph.MasterException) as error:
        pipe.tell(REFUSED, why="master", text=str(error))
        return None
    if _lives(master, "/" + name):
        pipe.tell(REFUSED, why="name", text="/" + name)
        return None
    socket.setdefaulttimeout(None)
    if sim_time and not (master.hasParam(SIM_TIME) and master.getParam(SIM_TIME)):
        master.setParam(SIM_TIME, True)
        rospy.on_shutdown(lambda: master.deleteParam(SIM_TIME))
    configure = tcp._configure_pub_socket
    tcp._configure_pub_socket = lambda sock, _: configure(sock, True)  # subscribers seldom ask, and Nagle costs 40 ms
    rospy.init_node(name, argv=[name], disable_signals=True, disable_rostime=True, log_level=rospy.ERROR)
    logging.getLogger("rospy").addHandler(Warnings(pipe))
    logging.getLogger("rosout").addHandler(Warnings(pipe))
    return rospy


def _lives(master: Any, name: str) -> bool:
    """Whether a node of this name answers."""
    import rosgraph

    try:
        ServerProxy(master.lookupNode(name)).getPid(name)
    except (OSError, Error, rosgraph.MasterException):
        return False
    return True


def _publishers(master: Any, topic: str) -> Optional[List[str]]:
    """The nodes that publish on a topic; None where the master does not answer."""
    try:
        return list(dict(master.getSystemState()[0]).get(topic, []))
    except OSError:
        return None


def main() -> None:
    """Serve BASU until it closes the pipe; the arguments are the node's name and whether time is simulated."""
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # rospy writes its log on standard output
    pipe, frames = Pipe(out), sys.stdin.buffer
    try:
        rospy = _start(sys.argv[1], sys.argv[2] == "sim", pipe)
        if rospy is None:
            return
        bridge = Bridge(rospy, pipe)
        threading.Thread(target=bridge.watch, daemon=True).start()
        import rosgraph

        master = rosgraph.Master(sys.argv[1])
        pipe.tell(READY)
        while True:
            head = _read(frames, HEAD.size)
            content = None if head is None else _read(frames, HEAD.unpack(head)[2])
            if head is None or content is None:
                break
            kind, number, _ = HEAD.unpack(head)
            if kind == PUBLISH:
                bridge.publish(number, content)
            elif kind == MASTER:
                pipe.tell(ANSWER, nodes=_publishers(master, content.decode()))
            else:
                (bridge.announce if kind == ANNOUNCE else bridge.listen)(number, json.loads(content.decode()))
        rospy.signal_shutdown("the run is over")
    except Exception:  # noqa: BLE001 - whatever it is, BASU says it
        pipe.tell(ENDED, reason=traceback.format_exc(limit=3))


if __name__ == "__main__":
    main()
