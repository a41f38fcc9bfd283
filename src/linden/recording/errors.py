"""What is wrong with a recording, as sentences that say where."""

from linden.errors import UserError


class RecordingError(UserError):
    """A file is no recording, or damaged; ``offset`` is the byte where that shows."""

    def __init__(self, sentence: str, offset: int) -> None:
        super().__init__(sentence)
        self.offset = offset


class NoRecordingError(RecordingError):
    """A file that CARLA's recorder has not written."""


class CutShortError(RecordingError):
    """A recording ends inside a frame, as that of a server that was killed may; all whole frames before are good."""
