"""A bag from a run's record: state, controls, other actors, contacts and crossed markings, without a simulator."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu_ros import vehicle_messages as of_vehicle
from basu_ros.bag_file import BagFile
from basu_ros.moment import Actor, Control, Moment, Motion, Vehicle
from basu_ros.topics import first_messages, moment_messages, vehicle_topics
from linden_ros2 import basic_messages as basic
from linden_ros2.sensor_messages import MARKINGS, collision_message, lane_invasion_message
from linden_ros2.topic import Message, Topic, control_of

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    import numpy as np

    from basu.records.history import History
    from linden_ros2.types import Generation, Types

ROLE = "hero"  # of the vehicle under test, as `basu.episode.world` calls it
BRAKED = Control(brake=1.0)  # what the vehicle has before its first control


def write_record(history: History, path: Path, generation: Generation) -> int:
    """Write the record of a run as a bag and return the number of its messages.

    Raises:
        UserError: it cannot be written.
    """
    vehicle = Vehicle(ROLE, step_s=history.facts.step_s)
    bag = BagFile(path, generation)
    try:
        bag.announce([*vehicle_topics(vehicle), *event_topics(ROLE), control_of(ROLE)])
        bag.write(0.0, first_messages(bag.types, vehicle, 0.0))
        for moment, command in moments(history):
            bag.write(moment.t_s, moment_messages(bag.types, vehicle, moment))
            bag.write(moment.t_s, [command_message(bag.types, ROLE, command, moment.t_s)])
        for t_s, message in event_messages(bag.types, ROLE, history):
            bag.write(t_s, [message])
        bag.close()
    except BaseException:
        bag.abandon()
        raise
    return bag.messages


def moments(history: History) -> Iterator[tuple[Moment, Control]]:
    """Yield each frame of a record with the control that was requested in it."""
    applied, rows = BRAKED, _others_by_tick(history)
    for frame in history.frames:
        motion = Motion(*(float(frame[name]) for name in Motion._fields))
        tick = int(frame["tick"])
        yield Moment(float(frame["t_s"]), tick, motion, applied, rows.get(tick, ())), _control(frame, "")
        applied = _control(frame, "applied_")


def command_message(types: Types, role: str, command: Control, t_s: float) -> Message:
    """Return the control that the agent asked for in a frame."""
    return Message(control_of(role), of_vehicle.control_message(types, command, t_s))


def event_topics(role: str) -> list[Topic]:
    """Return the topics of contacts and of crossed markings."""
    return [
        Topic(f"/carla/{role}/collision", "carla_msgs/msg/CarlaCollisionEvent"),
        Topic(f"/carla/{role}/lane_invasion", "carla_msgs/msg/CarlaLaneInvasionEvent"),
    ]


def event_messages(types: Types, role: str, history: History) -> Iterator[tuple[float, Message]]:
    """Yield contacts and crossed markings of a record with their times."""
    collisions, invasions = event_topics(role)
    step_s = history.facts.step_s
    for contact in history.collisions:
        t_s = contact.tick * step_s
        header = basic.header(types, t_s, of_vehicle.MAP)
        yield t_s, Message(collisions, collision_message(types, header, contact.other_id, contact.impulse_ns))
    for crossing in history.lane_invasions:
        t_s = crossing.tick * step_s
        kinds = [MARKINGS.get(marking.partition("/")[0], 0) for marking in crossing.markings]
        header = basic.header(types, t_s, role)
        yield t_s, Message(invasions, lane_invasion_message(types, header, kinds))


def _control(frame: np.void, prefix: str) -> Control:
    """A control of a frame: the requested one, or the applied one."""
    throttle, steer, brake = (float(frame[f"{prefix}{name}"]) for name in ("throttle", "steer", "brake"))
    return Control(throttle, steer, brake, bool(frame[f"{prefix}hand_brake"]), bool(frame[f"{prefix}reverse"]))


def _others_by_tick(history: History) -> dict[int, list[Actor]]:
    """The actors near the vehicle, by tick."""
    facts = history.facts
    rows: dict[int, list[Actor]] = {}
    for row in history.others.tolist():
        tick, actor_id, *motion = row
        kind, sizes = facts.actor_types.get(actor_id, ""), facts.actor_sizes.get(actor_id, (0.0, 0.0))
        rows.setdefault(tick, []).append(Actor._make((actor_id, kind, *motion, *sizes)))
    return rows
