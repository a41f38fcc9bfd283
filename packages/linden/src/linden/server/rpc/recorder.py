"""The recorder and the replayer. Source of names and texts: LibCarla 0.9.16, ``CarlaReplayer.cpp``.

Where files lie and why: docs/decisions/0020-recordings.md.
"""

import math
import time
from collections.abc import Callable
from pathlib import Path

from linden.errors import Refusal
from linden.protocol.values.space import Transform
from linden.protocol.wire.decode import U8, U32
from linden.replay.file.contents_report import file_info
from linden.replay.file.packets import NoRecordingError, RecordingError
from linden.replay.file.read import Recording
from linden.replay.file.reports import ASKED_FOR, blocked, collisions, number
from linden.replay.file.track import track_of
from linden.replay.replayer import Replayer, ReplayPlan
from linden.server.rpc.context import Context
from linden.server.rpc.registry import Long, method

MOST_TIMES_FASTER = 1000.0
"""Largest time factor; beyond it a step of a replay is longer than most recordings."""


@method("start_recorder")
def start_recorder(context: Context, name: str, additional_data: bool) -> str:  # noqa: FBT001 - the wire's order
    """Record from the next frame on and return the file's path; what is recorded or replayed meanwhile ends."""
    simulation, path = context.world, context.recordings.file(name)
    simulation.replayer.stop(keep_actors=False)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        simulation.recorder.start(
            path, simulation.episode, _short(simulation.map_name), time.time, additional_data=additional_data
        )
    except OSError as error:
        raise Refusal(
            f"the recording {path} cannot be written: {error.strerror or error}; make room or give another name, or "
            f"start the server with --recordings DIR"
        ) from error
    return str(path)


@method("stop_recorder")
def stop_recorder(context: Context) -> None:
    """End the recording, if one is under way."""
    context.world.recorder.stop()


@method("show_recorder_file_info")
def show_recorder_file_info(context: Context, name: str, show_all: bool) -> Long[str]:  # noqa: FBT001 - the wire's order
    """Return the report of a recording: spawns, destructions and collisions, or with ``show_all`` everything."""
    return _report(context, name, lambda recording: file_info(recording, show_all=show_all))


@method("show_recorder_collisions")
def show_recorder_collisions(context: Context, name: str, first_kind: U8, second_kind: U8) -> Long[str]:
    """Return the report of collisions; kinds are letters, sent as their codes."""
    first, second = chr(first_kind), chr(second_kind)
    if not {first, second} <= set(ASKED_FOR):
        kinds = ", ".join(f"'{letter}' {meaning}" for letter, meaning in ASKED_FOR.items())
        raise Refusal(f"collisions between '{first}' and '{second}': no such kinds of actors; the kinds are {kinds}")
    return _report(context, name, lambda recording: collisions(recording, first, second))


@method("show_recorder_actors_blocked")
def show_recorder_actors_blocked(context: Context, name: str, min_time: float, min_distance: float) -> Long[str]:
    """Return the actors that moved less than ``min_distance`` (cm) for ``min_time`` (s) or longer."""
    return _report(context, name, lambda recording: blocked(recording, min_time, min_distance))


def _report(context: Context, name: str, tell: Callable[[Recording], str]) -> Long[str]:
    """Return a report, or CARLA's words where there is no such file or it is no recording."""
    path = context.recordings.file(name)
    report: str = yield lambda: _told_of(path, tell)
    return report


def _told_of(path: Path, tell: Callable[[Recording], str]) -> str:
    """Return the report of a file.

    Raises:
        Refusal: it is a recording, but none that can be read.
    """
    recording = _opened(path)
    if isinstance(recording, str):
        return recording
    with recording:
        try:
            return tell(recording)
        except RecordingError as error:
            raise Refusal(str(error)) from error


def _opened(path: Path) -> Recording | str:
    """Return a recording, or CARLA's words for why not.

    Raises:
        Refusal: it is a recording, but none that can be read.
    """
    try:
        return Recording(path)
    except OSError:
        return f"File {path} not found on server\n"
    except NoRecordingError:
        return "File is not a CARLA recorder\n"
    except RecordingError as error:
        raise Refusal(str(error)) from error


@method("replay_file")
def replay_file(
    context: Context,
    name: str,
    start: float,
    duration: float,
    follow_id: U32,
    replay_sensors: bool,  # noqa: FBT001 - the wire's order
    offset: Transform,
) -> Long[str]:
    """Replay a recording from the next frame on, on its own map; what is recorded or replayed meanwhile ends."""
    if not (math.isfinite(start) and math.isfinite(duration)):
        raise Refusal(f"replay_file: start {start} and duration {duration} must be finite numbers of seconds")
    simulation, path = context.world, context.recordings.file(name)
    simulation.recorder.stop()
    told = f"Replaying File: {path}\n"
    recording = _opened(path)
    if isinstance(recording, str):
        simulation.replayer.stop(keep_actors=False)
        return told + recording
    map_name = recording.header.map_name
    if map_name != _short(simulation.map_name):
        try:
            ready = context.maps.ready(map_name) or (yield lambda: context.maps.make(map_name))
        except Refusal:
            recording.close()
            return f"{told}Could not load mapfile {map_name}\n"
        context.maps.keep(ready)
        yield lambda: simulation.prepare(ready)
        simulation.load(ready, reset_settings=True)
        told += f"Loading map {map_name}\nReplayer will start after map is loaded...\n"
    try:
        track = yield lambda: track_of(recording)
        span = simulation.replayer.start(
            simulation, track, ReplayPlan(start, duration, follow_id, offset, replay_sensors)
        )
    except RecordingError as error:
        raise Refusal(str(error)) from error
    total = number(span.total_s)
    told += f"Total time recorded: {total}\n"
    told += f"Replaying from {number(span.start_s)} s - {number(span.stop_s)} s ({total} s) at "
    return told + f"{simulation.replayer.time_factor:.1f}x\n" + _left_out(simulation.replayer)


def _left_out(replayer: Replayer) -> str:
    hero = "Ignoring Hero vehicle\n" if replayer.ignore_hero else ""
    return hero + ("Ignoring Spectator camera\n" if replayer.ignore_spectator else "")


def _short(map_name: str) -> str:
    """Return a map's name as recordings have it: without its folders."""
    return map_name.rsplit("/", 1)[-1]


@method("stop_replayer")
def stop_replayer(context: Context, keep_actors: bool) -> None:  # noqa: FBT001 - the wire's order
    """End the replay, if one is under way."""
    context.world.replayer.stop(keep_actors=keep_actors)


@method("set_replayer_time_factor")
def set_replayer_time_factor(context: Context, time_factor: float) -> None:
    """Set how fast replays go, the one under way too; 0 holds it."""
    if not 0.0 <= time_factor <= MOST_TIMES_FASTER:
        raise Refusal(f"a replay's time factor lies between 0 and {MOST_TIMES_FASTER:g}, not at {time_factor:g}")
    context.world.replayer.time_factor = time_factor


@method("set_replayer_ignore_hero")
def set_replayer_ignore_hero(context: Context, ignore_hero: bool) -> None:  # noqa: FBT001 - the wire's order
    """Leave the hero out of the next replays, or let it in."""
    context.world.replayer.ignore_hero = ignore_hero


@method("set_replayer_ignore_spectator")
def set_replayer_ignore_spectator(context: Context, ignore_spectator: bool) -> None:  # noqa: FBT001 - the wire's order
    """Leave the spectator where it is in the next replays, or move it as recorded."""
    context.world.replayer.ignore_spectator = ignore_spectator
