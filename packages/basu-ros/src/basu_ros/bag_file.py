"""A ROS bag that is being written: a folder with MCAP for ROS 2, or one file for ROS 1; the same bytes for a seed."""

from __future__ import annotations

import contextlib
import shutil
from typing import TYPE_CHECKING, Any, Final

from rosbags import interfaces as i
from rosbags import rosbag1, rosbag2

from basu.errors import UserError
from linden_ros2.basic_messages import nanoseconds
from linden_ros2.types import Generation, types_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from linden_ros2.topic import Message, Topic

VERSION: Final = 8  # of rosbag2's metadata: QoS as text, which Humble, Iron and Jazzy read
FOREVER = (9223372036, 854775807)  # rosbag2's infinite duration, s and ns


class BagFile:
    """A bag that is open for writing. Times are those of the simulation."""

    def __init__(self, path: Path, generation: Generation) -> None:
        """Begin the bag ``path``: a folder for ROS 2, a file for ROS 1.

        Raises:
            UserError: something of that name exists, or it cannot be written.
        """
        self.types = types_of(generation)
        self._path, self._generation = path, generation
        self._topics: dict[str, Any] = {}
        self.messages = 0
        with _writing(path):
            self._writer = rosbag1.Writer(path) if generation is Generation.ROS_1 else _ros_2(path)
            self._writer.open()

    def announce(self, topics: Iterable[Topic]) -> None:
        """Put topics into the bag that may stay empty."""
        for topic in topics:
            self._connection(topic)

    def write(self, t_s: float, messages: Iterable[Message]) -> None:
        """Append messages with the simulated time ``t_s``.

        Raises:
            UserError: the disk is full.
        """
        for topic, content in messages:
            connection = self._connection(topic)
            with _writing(self._path):
                self._writer.write(connection, nanoseconds(t_s), self.types.data(content))
            self.messages += 1

    def close(self) -> None:
        """Write the index; readers need it.

        Raises:
            UserError: the disk is full.
        """
        with _writing(self._path):
            self._writer.close()

    def abandon(self) -> None:
        """Remove what was written."""
        with contextlib.suppress(OSError):
            self._writer.abort()
        shutil.rmtree(self._path, ignore_errors=True)
        with contextlib.suppress(OSError):
            self._path.unlink(missing_ok=True)

    def _connection(self, topic: Topic) -> Any:  # noqa: ANN401 - of rosbags
        """The entry of a topic in the bag."""
        if topic.name not in self._topics:
            is_first = self._generation is Generation.ROS_1
            offered = {"latching": int(topic.is_latched)} if is_first else {"offered_qos_profiles": [_qos(topic)]}
            with _writing(self._path):
                self._topics[topic.name] = self._writer.add_connection(
                    topic.name, topic.type, typestore=self.types.store, **offered
                )
        return self._topics[topic.name]


@contextlib.contextmanager
def _writing(path: Path) -> Iterator[None]:
    """Turn the errors of the disk and of rosbags into a sentence."""
    try:
        yield
    except OSError as error:
        raise UserError(f"the bag {path} cannot be written: {error.strerror}; make room or name another place") from (
            error
        )
    except (rosbag1.WriterError, rosbag2.WriterError) as error:
        raise UserError(f"the bag {path} cannot be written: {error}") from error


def _ros_2(path: Path) -> Any:  # noqa: ANN401 - of rosbags
    """A writer of MCAP with compressed chunks; a message's bytes stay as they are on the wire."""
    writer = rosbag2.Writer(path, version=VERSION, storage_plugin=rosbag2.StoragePlugin.MCAP)
    writer.set_compression(rosbag2.CompressionMode.STORAGE, rosbag2.CompressionFormat.ZSTD)
    return writer


def _qos(topic: Topic) -> Any:  # noqa: ANN401 - of rosbags
    """The QoS that `ros2 bag play` offers: a latched topic reaches late subscribers."""
    forever = i.QosTime(*FOREVER)
    return i.Qos(
        i.QosHistory.KEEP_LAST,
        topic.depth,
        i.QosReliability.RELIABLE if topic.is_reliable else i.QosReliability.BEST_EFFORT,
        i.QosDurability.TRANSIENT_LOCAL if topic.is_latched else i.QosDurability.VOLATILE,
        forever,
        forever,
        i.QosLiveliness.AUTOMATIC,
        forever,
        avoid_ros_namespace_conventions=False,
    )
