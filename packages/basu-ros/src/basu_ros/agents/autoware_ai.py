"""``basu run autoware-ai``: an Autoware.AI of ROS 1 beside the run drives the vehicle, in lock-step at a roscore.

The software's nodes have timers and loops of their own, on the simulated clock. So the clock runs on within a frame
while a command is awaited, up to the next frame. A command that is a little older than the frame is accepted then. A
loop that has missed its turn wakes in the next frame only; so the last command holds when nothing newer comes for a
while, and the clock slows down until the nodes keep up.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import carla

from basu.errors import AgentTimedOutError
from basu.thresholds import AT_REST_MPS
from basu_ros import autoware_ai as ai
from basu_ros import vehicle_messages as of_vehicle
from basu_ros.agents.autoware_base import AutowareBase
from basu_ros.agents.commands import Wanted, finite
from basu_ros.agents.legs import Legs
from basu_ros.agents.lockstep import NODE, is_answer
from basu_ros.agents.ros1 import FIRST_S
from basu_ros.ros1 import Ros1Node
from basu_ros.topics import odometry_of, path_message, path_of
from linden_ros2 import basic_messages as basic
from linden_ros2.topic import CLOCK, Message

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu_ros.moment import Moment
    from linden_ros2.topic import Topic
    from linden_ros2.types import Types

TICK_S = 0.01  # of the clock within a frame, simulated time
PACE_S = 0.002  # wall time a tick: a message crosses two or three nodes in it
SLOWEST_S = 0.04  # the same where the nodes do not keep up: on a machine with other work, for example
SLOWER, FASTER = 2.0, 0.98  # factors of the wall time a tick: after a frame with an old command, and after each frame
OLDEST_S = 0.2  # simulated time: two scans of a lidar at 10 Hz, which a localisation answers one late
GRACE_S = 0.04  # wall time that a frame waits for a fresh command before it takes the one of a frame before
PATIENCE_S = 0.5  # wall time after which a frame takes an even older command: with a clock that stands no loop wakes
HELD_S = 1.0  # simulated time: the oldest command that is taken so
STARTING_S = 0.5  # wall time that a frame waits for the very first command
LOCALISED = (ai.CURRENT_POSE.name, ai.NDT_POSE.name)
"""Topics of a localisation. `ndt_matching` names its own at its start. A relay names the other with the first pose,
which needs the point cloud. Until then the software would drive by our pose, and NDT would begin at a wrong place."""


class AutowareAiAgent(AutowareBase):
    """Autoware.AI's topics: sensing, vehicle status, goal, localisation if it has none; ``/vehicle_cmd`` in."""

    first_s = FIRST_S
    slice_s = PACE_S
    node: Ros1Node

    def setup(self) -> None:
        """Publish the mission, and wait until an Autoware.AI appears."""
        self.tyre_angle_rad = 0.0
        self._has_commanded = self._localises_itself = False
        self._tick = 0
        self._latest: Any = None  # the last command
        self._types: Types | None = None  # in the software's version, once it is known
        self._began_s = self._frame_began_s = time.monotonic()
        super().setup()

    def new_node(self) -> Ros1Node:
        """Return a node at the master that takes commands of any version."""
        node = Ros1Node(NODE, in_lockstep=True)
        node.listen(ai.COMMAND, any_version=True)
        return node

    def topics(self) -> Sequence[Topic]:
        """Return Autoware.AI's topics; CARLA's odometry tells the truth to tools that compare."""
        role = self.described.role
        return [*ai.sensing_topics(self.described), path_of(role), odometry_of(role)]

    def commands(self) -> Sequence[Topic]:
        """Return the command to the vehicle."""
        return [ai.COMMAND]

    def still(self, t_s: float) -> Sequence[Message]:
        """Return the transforms that never move."""
        return ai.still_messages(self.node.types, self.described, t_s)

    def beginning(self) -> Sequence[Message]:
        """Return transforms, the first goal, the order to drive, and the route as a path."""
        types, way = self.node.types, self.way()
        route = path_message(types, self.described.role, way)
        assert self.route is not None, "it has a way"
        self._legs = Legs(self.route)
        return [*self.still(self.first_s), *ai.mission(types, way[self._legs.goal], self.first_s), route]

    def messages(self, moment: Moment) -> Sequence[Message]:
        """Return what Autoware.AI's nodes take in a frame, the clock last: its loops then find what they wait for."""
        types, vehicle = self.node.types, self.described
        self._tick, self._frame_began_s = 0, time.monotonic()
        self.slice_s = max(PACE_S, self.slice_s * FASTER)
        if not self._has_commanded:
            self._localises_itself = any(map(self.node.publishers_of, LOCALISED))
        sent = list(ai.sensing_messages(types, vehicle, moment))
        sent.append(Message(odometry_of(vehicle.role), of_vehicle.odometry(types, vehicle, moment, of_vehicle.BASE)))
        peers = self.node.peers_of(ai.COMMAND)
        if peers and self._types is None and peers[0].definition:
            self._types = ai.old_types() if ai.is_old(peers[0].definition) else types
        if self._types is not None:
            self.node.publish_as(self._types, ai.status_message(self._types, vehicle, moment, self.tyre_angle_rad))
        if moment.frame == 0:
            sent.append(ai.initial_pose(types, vehicle, moment))
        goal = self._legs.advance(moment.motion.x_m, moment.motion.y_m)
        if goal is not None:
            sent.append(ai.goal_message(types, self.way()[goal], moment.t_s))
        if not self._localises_itself:
            sent.extend(ai.localisation_messages(types, vehicle, moment))
        return [*sent, Message(CLOCK, basic.clock(types, moment.t_s))]

    def belongs(self, message: Any, moment: Moment) -> bool:  # noqa: ANN401 - a message
        """Return whether a command answers a frame at once; an older one is kept for the end of the frame."""
        self._latest = message
        return is_answer(message, moment.t_s)

    def waiting(self, moment: Moment) -> carla.VehicleControl | None:
        """Let the clock run on within the frame, then take a command that is a little older.

        Before the first command, brake after a while and let time pass.

        Raises:
            AgentTimedOutError: the software has not commanded once.
        """
        if not self._is_over:
            self._tick += 1
            t_s = moment.t_s + self._tick * TICK_S
            self.node.publish(Message(CLOCK, basic.clock(self.node.types, t_s)))
            return None
        now_s = time.monotonic()
        if self._latest is not None and is_answer(self._latest, moment.t_s - HELD_S):
            is_fresh = is_answer(self._latest, moment.t_s - OLDEST_S)
            if now_s < self._frame_began_s + (GRACE_S if is_fresh else PATIENCE_S):
                return None
            if not is_fresh:
                self.slice_s = min(SLOWEST_S, self.slice_s * SLOWER)
            return self._control(self.wanted(ai.COMMAND, self._latest), moment)
        if self._has_commanded or now_s < self._frame_began_s + STARTING_S:
            return None
        if now_s > self._began_s + self.appears_s:
            raise AgentTimedOutError(
                f"the ROS 1 software published nothing on {ai.COMMAND.name} within {self.appears_s:g} s, though it is "
                "there; see its own output"
            )
        return carla.VehicleControl(brake=1.0)

    def wanted(self, topic: Topic, message: Any) -> Wanted:  # noqa: ANN401 - a message
        """Return what a command wants.

        Raises:
            AgentInvalidControlError: a value is no finite number.
        """
        del topic
        self._has_commanded = True
        order = ai.ordered(message)
        speed = finite(order.speed_mps, "speed")
        rate = finite(order.yaw_rate_radps, "twist_cmd.twist.angular.z")
        if order.is_emergency:
            return Wanted(0.0, self.tyre_angle_rad)
        assert self.facts is not None, "the first frame reads them"
        if order.tyre_angle_rad is not None:
            self.tyre_angle_rad = finite(order.tyre_angle_rad, "ctrl_cmd.steering_angle")
        elif abs(speed) > AT_REST_MPS:
            self.tyre_angle_rad = ai.tyre_angle_rad(speed, rate, self.facts.body.wheelbase_m)
        return Wanted(speed, self.tyre_angle_rad)

    @property
    def _is_over(self) -> bool:
        """Whether the clock has come to the end of the frame."""
        return (self._tick + 1.5) * TICK_S > self.time_step_s
