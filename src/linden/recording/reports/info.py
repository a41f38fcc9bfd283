"""``show_recorder_file_info``: what is in a recording, frame after frame. Source: ``CarlaRecorderQuery.cpp``."""

from collections.abc import Iterator

from linden.recording.layouts import PacketId
from linden.recording.packets import Frame
from linden.recording.read import Recording
from linden.recording.reports.blocks import EVENTS, STATES
from linden.recording.reports.wording import ending, heading, number

_LEFT_OUT_WHEN_EMPTY = (PacketId.DOORS, PacketId.WEATHER)
"""CARLA writes a heading for no doors before all positions, and ScenarioRunner's parser then reads none of them."""


def file_info(recording: Recording, *, show_all: bool) -> str:
    """Return the report; without ``show_all`` only of frames in which somebody came, went, was attached or collided."""
    parts = [heading(recording.header)]
    last_number, elapsed_s = 0, 0.0
    for frame in recording.whole_frames():
        last_number, elapsed_s = frame.number, frame.elapsed_s
        told = "".join((*_events(frame), *_states(frame, show_all=show_all)))
        if told or show_all:
            parts.append(f"Frame {frame.number} at {number(frame.elapsed_s)} seconds\n{told}")
        parts.append("\n")
    parts.append("\n")  # CARLA meets the last frame's end twice
    parts.append(ending(last_number, number(elapsed_s)))
    return "".join(parts)


def _events(frame: Frame) -> Iterator[str]:
    for packet, tell in EVENTS:
        if packet in frame.packets:
            yield from tell(frame.packets[packet])


def _states(frame: Frame, *, show_all: bool) -> Iterator[str]:
    for packet, name, tell in STATES:
        if packet not in frame.packets or not (show_all or packet is PacketId.WEATHER):
            continue
        content = frame.packets[packet]
        if packet is PacketId.PLATFORM_TIME:
            yield f" {name}: {number(content)}\n"
        elif len(content) or packet not in _LEFT_OUT_WHEN_EMPTY:
            yield f" {name}: {len(content)}\n"
            yield from tell(content)
