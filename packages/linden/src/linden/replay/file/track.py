"""A recording made ready to be replayed: where its frames lie, and what happens in them beside motion."""

import logging
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.background import checkpoint
from linden.replay.file.layouts import PacketId
from linden.replay.file.packets import CutShortError, Frame, RecordingError
from linden.replay.file.read import FramePlace, Recording

log = logging.getLogger("linden")

_EVENTS = frozenset((PacketId.ADDED, PacketId.REMOVED, PacketId.PARENTS, PacketId.SCENE_LIGHTS, PacketId.DOORS))


class RecordingTrack(NamedTuple):
    """What a replay needs to know of a recording before it begins.

    Attributes:
        recording: open.
        places: of its whole frames.
        elapsed_s: (N,) of each, since the recording began; they go forward.
        events: the frames, by their place in ``places``, in which actors are added or removed or lamps switched, with
            these packets alone; or the error by which such a frame is damaged.
    """

    recording: Recording
    places: list[FramePlace]
    elapsed_s: NDArray[np.float64]
    events: dict[int, Frame | RecordingError]


def track_of(recording: Recording) -> RecordingTrack:
    """Read through a recording; no other reader may use it meanwhile. It is closed where it is damaged.

    Raises:
        RecordingError: there is no whole frame, or what is there cannot be.
    """
    try:
        return _track_of(recording)
    except BaseException:
        recording.close()
        raise


def _track_of(recording: Recording) -> RecordingTrack:
    places: list[FramePlace] = []
    try:
        for place in recording.places():
            checkpoint()
            places.append(place)
    except CutShortError as error:
        log.warning("%s", error)
    elapsed_s = np.array([place.elapsed_s for place in places])
    if not (np.isfinite(elapsed_s).all() and (np.diff(elapsed_s) >= 0.0).all()):
        raise RecordingError(f"{recording.path}: damaged recording: the times of its frames do not go forward", 0)
    if not places:
        raise RecordingError(f"{recording.path} holds no whole frame, so there is nothing to replay", 0)
    found = ((at, _events_of(recording, place)) for at, place in enumerate(places))
    return RecordingTrack(recording, places, elapsed_s, {at: event for at, event in found if event is not None})


def _events_of(recording: Recording, place: FramePlace) -> Frame | RecordingError | None:
    try:
        frame = recording.frame(place, _EVENTS)
    except RecordingError as error:
        return error
    return frame if frame.packets else None
