"""The base of agents that are ROS software: it drives on CARLA's topics, and simulated time waits for its commands.

The agent publishes the frame and the clock. Then it waits for a command of the same time, or of no time at all. A
command that does not come within the limit of a step is the agent's time-out.
"""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Any

import carla

from basu.agents.autonomous_agent import AutonomousAgent
from basu.agents.builtin.perception import SHUTTLE, read_facts
from basu.agents.calls import SETUP_LIMIT_S, OverrunError
from basu.agents.sensor_file import read_sensors
from basu.errors import AgentCrashedError, AgentInvalidControlError, AgentTimedOutError, UserError
from basu.files import find
from basu_ros.agents.commands import AckermannControl, Wanted, ackermann_command, carla_command
from basu_ros.agents.vehicle_source import BRAKED, VehicleSource, actor_of, control_of, info_message
from basu_ros.moment import Vehicle
from basu_ros.topics import first_messages, moment_messages, objects_of, path_message, path_of, vehicle_topics
from linden_ros2.basic_messages import nanoseconds
from linden_ros2.topic import Message, Topic, ackermann_of
from linden_ros2.topic import control_of as control_topic

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.agents.builtin.perception import VehicleFacts
    from basu_ros.moment import Moment
    from basu_ros.node import RosNode

APPEARS_S = SETUP_LIMIT_S - 20.0  # wall time for the software to appear on the domain: it may load maps and networks
UNHEARD_S = 5.0  # wall time for DDS to compare types, and for another node to appear beside one that cannot be heard
SLICE_S = 0.02  # of waiting: in between, the step's time limit can interrupt
NODE = "basu"


class LockstepAgent(AutonomousAgent):
    """CARLA's topics: ``vehicle_control_cmd`` or ``ackermann_cmd`` drives. A subclass makes the node."""

    facts: VehicleFacts | None = None
    appears_s = APPEARS_S
    slice_s = SLICE_S
    first_s = 0.0  # the time of the first frame
    node: RosNode

    def setup(self) -> None:
        """Publish what does not move, and wait until software that commands appears on the domain."""
        file = self.config_values.get("sensors")
        specs = () if file is None else read_sensors(find(str(file), "sensor file"))
        self._source = VehicleSource(self.world, self.vehicle, specs, self.time_step_s, self.first_s)
        self._applied = BRAKED
        self._ackermann: AckermannControl | None = None
        self.facts = None
        role = self.vehicle.attributes["role_name"]
        mounts = tuple(self._source.mounts.values())
        self.described = Vehicle(role, mounts, self.time_step_s)
        topics = self.topics()
        self.node = self.new_node()
        self.node.listen(*self.commands())
        self.node.announce(*topics)
        self.node.publish(*self.beginning())
        self._await_software()

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        """Publish the frame, wait for its command, and turn that into pedals and wheel."""
        moment = self._source.moment(sensor_data, self._applied)
        if moment is None:
            return carla.VehicleControl(brake=1.0)  # not in the world before its first tick
        if self.facts is None:
            self.facts = read_facts(self.vehicle, self.vehicle.get_transform())
            self.described = self.described._replace(rear_axle_m=self.axle_m(self.facts))
            self.node.publish(*self.still(moment.t_s), info_message(self.node.types, self.vehicle))
        if self.node.readers_of(objects_of(self.described.role)):
            moment = moment._replace(others=[actor_of(other) for other in self.visible_actors()])
        self._check_alone()
        self.node.publish(*self.messages(moment))
        control = self._control(self._command(moment), moment)
        self._applied = control_of(control)
        return control

    def config(self) -> dict[str, str]:
        """The shuttle on its round."""
        return {"routes": "routes/linden_leap.xml", "sensors": "config/sensors.json", "vehicle": SHUTTLE}

    def destroy(self) -> None:
        """Leave the domain."""
        if hasattr(self, "node"):
            self.node.close()

    # -- what differs from stack to stack

    def new_node(self) -> RosNode:
        """Return a node where the software is looked for."""
        raise NotImplementedError

    def topics(self) -> Sequence[Topic]:
        """Return the topics that are published."""
        return [*vehicle_topics(self.described), path_of(self.described.role)]

    def commands(self) -> Sequence[Topic]:
        """Return the topics on which commands come; any of them drives."""
        return [control_topic(self.described.role), ackermann_of(self.described.role)]

    def beginning(self) -> Sequence[Message]:
        """Return what is published before the first frame: transforms, and the route as a path."""
        return [*self.still(self.first_s), path_message(self.node.types, self.described.role, self.way())]

    def still(self, t_s: float) -> Sequence[Message]:
        """Return the transforms that never move."""
        return first_messages(self.node.types, self.described, t_s)

    def messages(self, moment: Moment) -> Sequence[Message]:
        """Return what is published in a frame."""
        return list(moment_messages(self.node.types, self.described, moment))

    def axle_m(self, _facts: VehicleFacts) -> float:
        """Return how far base_link lies behind the vehicle's origin."""
        return 0.0

    def belongs(self, message: Any, moment: Moment) -> bool:  # noqa: ANN401 - a message
        """Return whether a command answers a frame."""
        return is_answer(message, moment.t_s)

    def waiting(self, moment: Moment) -> carla.VehicleControl | None:
        """Do what is due while a command is awaited; a control ends the wait."""
        del moment
        return None

    def wanted(self, topic: Topic, message: Any) -> Wanted | carla.VehicleControl:  # noqa: ANN401 - a message
        """Return what a command says.

        Raises:
            AgentInvalidControlError: it holds what is no number.
        """
        return carla_command(message) if topic == control_topic(self.described.role) else ackermann_command(message)

    # -- the same for all

    def way(self) -> list[tuple[float, float, float, float]]:
        """Return x, y, z and yaw of the route's points, in CARLA's axes.

        Raises:
            UserError: the run has no route.
        """
        if self.route is None:
            raise UserError(f"{type(self).__name__} follows a route and was given none; name one with --routes")
        rows = zip(self.route.points_m.tolist(), self.route.yaw_rad.tolist(), strict=True)
        return [(*point, yaw) for point, yaw in rows]

    def _await_software(self) -> None:
        """Wait until a peer publishes commands.

        Raises:
            AgentTimedOutError: none appears, or none that can be heard.
        """
        until_s = time.monotonic() + self.appears_s
        unheard_since_s = math.inf
        while not any(self.node.writers_of(topic) for topic in self.commands()):
            unheard = self._unheard()
            unheard_since_s = min(unheard_since_s, time.monotonic()) if unheard else math.inf
            if unheard and time.monotonic() > min(until_s, unheard_since_s + UNHEARD_S):
                raise AgentTimedOutError(
                    f"no command can be heard: a {self.node.kind} node of {self.node.realm} publishes on {unheard[0]}"
                )
            if time.monotonic() > until_s:
                names = " or ".join(topic.name for topic in self.commands())
                raise AgentTimedOutError(
                    f"no {self.node.kind} node of {self.node.realm} publishes on {names} within {self.appears_s:g} s; "
                    f"start the software, and give both the same {self.node.settings}"
                )
            time.sleep(SLICE_S)  # discovery has no event that this could wait for

    def _unheard(self) -> list[str]:
        """The topics of commands with publishers that do not fit, each with the reason."""
        return [f"{topic.name} {reason}" for topic in self.commands() for reason in self.node.unheard(topic)]

    def _check_alone(self) -> None:
        """Check that one node drives. One that was killed stays on the domain until DDS misses it, so this waits.

        Raises:
            AgentCrashedError: several do.
        """
        until_s = time.monotonic() + self.node.missed_s
        try:
            while sum(self.node.writers_of(topic) for topic in self.commands()) > 1:
                if time.monotonic() > until_s:
                    raise self._several()
                time.sleep(SLICE_S)  # there is no event for it that could be waited for together with a time limit
        except OverrunError:
            raise self._several() from None

    def _several(self) -> AgentCrashedError:
        """The failure of several drivers."""
        writers = {topic.name: self.node.writers_of(topic) for topic in self.commands()}
        found = ", ".join(f"{count} on {name}" for name, count in writers.items() if count)
        return AgentCrashedError(
            f"several {self.node.kind} nodes command the vehicle ({found}); one may drive: end the others"
        )

    def _command(self, moment: Moment) -> Wanted | carla.VehicleControl:
        """The command that belongs to a frame.

        Raises:
            AgentTimedOutError: it does not come within the limit of a step.
        """
        stale: Any = None  # the last command of an earlier time
        try:
            while True:
                for topic in self.commands():
                    heard = self.node.received(topic)
                    fresh = [each for each in heard if self.belongs(each, moment)]
                    if fresh:
                        return self._read(topic, fresh[-1], moment)
                    stale = heard[-1] if heard else stale
                if not any(self.node.writers_of(topic) for topic in self.commands()):
                    raise AgentTimedOutError(
                        f"the {self.node.kind} software left {self.node.realm} before it answered frame "
                        f"{moment.frame}; see its own output"
                    )
                control = self.waiting(moment)
                if control is not None:
                    return control
                self.node.wait_any(self.commands(), self.slice_s)
        except OverrunError:
            names = " or ".join(topic.name for topic in self.commands())
            late = "" if stale is None else f" (the last one that came has the earlier time {_stamp_s(stale):.2f} s)"
            raise AgentTimedOutError(
                f"the {self.node.kind} software gave no command on {names} for frame {moment.frame} ({moment.t_s:.2f} "
                f"s){late} within the limit of a step; it is still there: see its own output, or give it more with "
                "--step-limit"
            ) from None

    def _read(self, topic: Topic, message: Any, moment: Moment) -> Wanted | carla.VehicleControl:  # noqa: ANN401
        """Return what a command says.

        Raises:
            AgentInvalidControlError: it holds what is no number; the text has the topic and the time.
        """
        try:
            return self.wanted(topic, message)
        except AgentInvalidControlError as error:
            raise AgentInvalidControlError(f"{topic.name} at {moment.t_s:.2f} s: {error}") from None

    def _control(self, wanted: Wanted | carla.VehicleControl, moment: Moment) -> carla.VehicleControl:
        """A command as CARLA's control."""
        if isinstance(wanted, carla.VehicleControl):
            return wanted
        assert self.facts is not None, "the first frame reads them"
        if self._ackermann is None:
            self._ackermann = AckermannControl(self.facts, self.time_step_s)
        motion = moment.motion
        speed = motion.velocity_x_mps * math.cos(motion.yaw_rad) + motion.velocity_y_mps * math.sin(motion.yaw_rad)
        return self._ackermann.step(wanted, speed, int(self.vehicle.get_control().gear))


def is_answer(message: Any, t_s: float) -> bool:  # noqa: ANN401 - a message
    """Return whether a command has the time ``t_s`` of a frame or a later one, or no time at all."""
    stamp = _stamp(message)
    if stamp is None:
        return True
    stamped_ns = stamp.sec * 1_000_000_000 + stamp.nanosec
    return bool(stamped_ns == 0 or stamped_ns >= nanoseconds(t_s))


def _stamp(message: Any) -> Any:  # noqa: ANN401 - messages
    """Return the stamp of a command, in its header or without one; None for a type without a stamp."""
    return getattr(getattr(message, "header", message), "stamp", None)


def _stamp_s(message: Any) -> float:  # noqa: ANN401 - a message
    """Return the stamp of a command that has one, in s."""
    stamp = _stamp(message)
    return float(stamp.sec + 1e-9 * stamp.nanosec)
