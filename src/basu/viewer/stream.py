"""Where what is shown goes: into an .rrd file, and to a viewer of Rerun's where there is a screen to open one on."""

from __future__ import annotations

import os
import platform
import socket
import subprocess
import sys
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.errors import UserError

if TYPE_CHECKING:
    from pathlib import Path

    from basu.viewer.layout import Parts

APPLICATION = "basu"
FLUSH_LIMIT_S = 20.0  # for a viewer that does not take what is sent any more
MISSING = "--viewer needs Rerun: install it with `pip install 'linden[viewer]'`, or run without --viewer"


class Stream(NamedTuple):
    """An open recording of Rerun's, and in words where it goes."""

    recording: Any  # rerun.RecordingStream
    said: str


def require() -> None:
    """Make sure that Rerun is there.

    Raises:
        UserError: it is not; says how to get it.
    """
    try:
        import rerun  # noqa: F401, PLC0415 - an extra
    except ImportError:
        raise UserError(MISSING) from None


def open_stream(file: Path, name: str, parts: Parts, *, screen: bool) -> Stream:
    """Begin a recording called ``name`` in ``file``; ``screen`` says whether a viewer may be opened.

    Simulated time is the only timeline.

    Raises:
        UserError: Rerun is missing, or the file cannot be begun.
    """
    require()
    import rerun as rr  # noqa: PLC0415 - an extra

    from basu.viewer.layout import layout  # noqa: PLC0415 - likewise

    try:
        file.open("wb").close()
    except OSError as error:
        raise UserError(f"{file} cannot be written: {error.strerror}; run without --viewer") from error
    recording = rr.RecordingStream(APPLICATION, recording_id=name, send_properties=False)
    recording.set_log_time_enabled(False)
    recording.set_log_tick_enabled(False)
    sinks: list[Any] = [rr.FileSink(file)]
    if screen:
        sinks.append(rr.GrpcSink(_viewer()))
        said = "in a window of Rerun's, and kept"
    else:
        said = "kept, as there is no screen here to show it on"
    recording.set_sinks(*sinks, default_blueprint=layout(parts))
    return Stream(recording, said)


def close_stream(stream: Stream) -> None:
    """Let everything arrive, and end the recording."""
    stream.recording.flush(timeout_sec=FLUSH_LIMIT_S)
    stream.recording.disconnect()


def has_screen() -> bool:
    """Whether there is a screen that a window could be on."""
    if platform.system() == "Linux":
        return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    return True


def _viewer() -> str:
    """Open a viewer that outlives us, reachable from this machine only; where to send things.

    Rerun's own ``spawn`` would listen on all addresses of the machine.
    """
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    subprocess.Popen(  # noqa: S603 - Rerun's own program, arguments of our own
        [sys.executable, "-m", "rerun", "--bind", "127.0.0.1", "--port", str(port), "--hide-welcome-screen"],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    return f"rerun+http://127.0.0.1:{port}/proxy"
