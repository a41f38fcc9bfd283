"""`Stream`: a Rerun recording that is written to an .rrd file and, if there is a screen, to a viewer."""

from __future__ import annotations

import contextlib
import os
import platform
import socket
import subprocess
import sys
import time
from typing import TYPE_CHECKING, Any, NamedTuple

import rerun as rr

from basu.errors import UserError
from basu_window.viewer.layout import layout

if TYPE_CHECKING:
    from pathlib import Path

    from basu_window.viewer.layout import Parts

APPLICATION = "basu"
OPEN_LIMIT_S, POLL_S, SETTLE_S = 20.0, 0.1, 2.0  # for a viewer to listen, and then to find that it cannot draw
FLUSH_LIMIT_S = 20.0  # for a viewer that does not take what is sent any more


class Stream(NamedTuple):
    """An open recording of Rerun's, and in words where it goes."""

    recording: Any  # rerun.RecordingStream
    said: str


def open_stream(file: Path, name: str, parts: Parts, *, screen: bool) -> Stream:
    """Begin a recording called ``name`` in ``file``; ``screen`` says whether a viewer may be opened.

    Simulated time is the only timeline.

    Raises:
        UserError: the file cannot be begun.
    """
    try:
        file.open("wb").close()
    except OSError as error:
        raise UserError(f"{file} cannot be written: {error.strerror}; run without --viewer") from error
    recording = rr.RecordingStream(APPLICATION, recording_id=name, send_properties=False)
    recording.set_log_time_enabled(False)
    recording.set_log_tick_enabled(False)
    sinks: list[Any] = [rr.FileSink(file)]
    port = _viewer() if screen else None
    if port is not None:
        sinks.append(rr.GrpcSink(f"rerun+http://127.0.0.1:{port}/proxy"))
        said = "in a window of Rerun's, and kept"
    elif screen:
        said = "kept; Rerun's window did not open, `rerun` by itself says why"
    else:
        said = "kept, as there is no screen here to show it on"
    recording.set_sinks(*sinks, default_blueprint=layout(parts))
    return Stream(recording, said)


def close_stream(stream: Stream) -> None:
    """Let everything arrive, and end the recording; the file is whole even after the window was closed."""
    with contextlib.suppress(RuntimeError):
        stream.recording.flush(timeout_sec=FLUSH_LIMIT_S)
    stream.recording.disconnect()


def has_screen() -> bool:
    """Return whether there is a screen that a window could be on."""
    if platform.system() == "Linux":
        return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    return True


def _viewer() -> int | None:
    """Open a viewer that outlives us, reachable from this machine only; the port it listens on, None where it ended.

    Rerun's own ``spawn`` would listen on all addresses of the machine.
    """
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    viewer = subprocess.Popen(  # noqa: S603 - Rerun's own program, arguments of our own
        [sys.executable, "-m", "rerun", "--bind", "127.0.0.1", "--port", str(port), "--hide-welcome-screen"],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    deadline_s = time.monotonic() + OPEN_LIMIT_S
    while viewer.poll() is None and time.monotonic() < deadline_s:
        with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), timeout=POLL_S):
            break
        time.sleep(POLL_S)
    with contextlib.suppress(subprocess.TimeoutExpired):  # it listens before it looks at the graphics driver
        viewer.wait(SETTLE_S)
    return port if viewer.poll() is None else None
