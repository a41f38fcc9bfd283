"""``linden serve``: open the ports, load the map, make the kernels ready, serve until told to stop."""

import argparse
import gc
import importlib
import logging
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from linden.cli.compiling import FirstStart
from linden.cli.process import Ending, allow_connections, background_work_ended, give_up_stdout, write_log
from linden.errors import UserError

DEFAULT_PORT = 2000
log = logging.getLogger("linden")

LOG_LEVELS = ("debug", "info", "warning", "error")


def add_parser(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command ``serve``."""
    serve = commands.add_parser("serve", help="run the server until Ctrl-C", description=__doc__)
    serve.add_argument("--host", "--bind", default="127.0.0.1", help="address to listen on (default: %(default)s)")
    serve.add_argument(
        "--port", type=int, default=DEFAULT_PORT, help="RPC port, 0 lets the system choose (default: %(default)s)"
    )
    serve.add_argument("--streaming-port", type=int, help="port of the sensor streams (default: the one after --port)")
    serve.add_argument("--map", default="Linden", help="map to begin with (default: %(default)s)")
    serve.add_argument(
        "--maps", type=Path, action="append", default=[], metavar="DIR", help="offer every .xodr of a folder as a map"
    )
    serve.add_argument(
        "--recordings",
        type=Path,
        metavar="DIR",
        help="folder that recordings are written to and replayed from (default: linden/recordings in the user's data)",
    )
    serve.add_argument(
        "--sync",
        action="store_true",
        help="begin in synchronous mode with steps of 0.05 s: no frame before the first tick",
    )
    serve.add_argument(
        "--device",
        default="cpu",
        metavar="NAME",
        help="where rays of cameras, lidars, radars are cast: cpu, or cuda with the extra gpu (default: %(default)s)",
    )
    serve.add_argument(
        "--gates",
        action="store_true",
        help="open and close gates for agents by lines on stdin, and accept other connections from the parent only",
    )
    serve.add_argument(
        "--window",
        action="store_true",
        help="print an address of a page that shows the world in a browser on this machine (needs the extra window)",
    )
    serve.add_argument(
        "--window-control",
        action="store_true",
        help="let the page of --window pause, step, spawn actors and change the weather; implies --window",
    )
    serve.add_argument(
        "--window-port", type=int, default=0, metavar="PORT", help="port of the page (default: the system chooses)"
    )
    serve.add_argument(
        "--ros2",
        action="store_true",
        help="publish sensors on ROS 2 and obey its commands, on this machine unless ROS's variables say otherwise "
        "(needs: pip install linden-ros2)",
    )
    serve.add_argument("--log-level", choices=LOG_LEVELS, default="warning", help="(default: %(default)s)")
    serve.set_defaults(command=run)


def run(arguments: argparse.Namespace) -> int:
    """Serve until SIGINT or SIGTERM.

    Raises:
        UserError: a port or a map cannot be had.
    """
    write_log(arguments.log_level.upper())
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # numpy would start one a core, and they spin; we are one thread
    allow_connections()
    first_start = FirstStart(_say)
    window = publisher = None
    with background_work_ended(), Ending() as ending:
        try:
            window = _window_of(arguments)
            publisher = _publisher_of(arguments)
            with _collector_paused():
                # here, not above: it brings in the compiler, which other commands of this program do not need
                from linden.cli.server_start import make_server  # noqa: PLC0415 - see above

                started = make_server(arguments, first_start)
                if window is not None:
                    _say(f"linden: window {window.attach(started.server)}")
                if publisher is not None:
                    _say(f"linden: ROS 2 {publisher.attach(started.server)}")
                _say(f"linden: ready, rpc port {started.rpc_port}, streaming port {started.streaming_port}")
            if arguments.gates:
                started.server.accept_only(os.getppid())
                started.server.obey(sys.stdin.fileno(), _say)
            ending.ask_first(started.server.stop)
            started.server.run()
        finally:
            first_start.end()
            for plugin in (window, publisher):
                if plugin is not None:
                    plugin.close()
    return 0


def _window_of(arguments: argparse.Namespace) -> Any:  # noqa: ANN401 - of another distribution
    """Start the process of the window's pages, if the user wants a window; None otherwise.

    Raises:
        UserError: the package of the window is not installed.
    """
    if not (arguments.window or arguments.window_control):
        return None
    module = _plugin("linden_window.attached", "--window")
    return module.AttachedWindow(may_control=arguments.window_control, port=arguments.window_port)


def _publisher_of(arguments: argparse.Namespace) -> Any:  # noqa: ANN401 - of another distribution
    """Return a new node of ROS 2, if the user wants one; None otherwise.

    Raises:
        UserError: its package is not installed, or ROS 2's domain cannot be joined.
    """
    return _plugin("linden_ros2.attached", "--ros2").AttachedPublisher() if arguments.ros2 else None


def _plugin(name: str, option: str) -> Any:  # noqa: ANN401 - a module
    """Return the module ``name`` of a plugin of the server.

    Raises:
        UserError: it is not installed.
    """
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError as error:
        distribution = name.partition(".")[0].replace("_", "-")
        raise UserError(
            f"{option} needs the package {error.name}, which comes with: pip install {distribution}"
        ) from None


@contextmanager
def _collector_paused() -> Iterator[None]:
    """Look for no garbage among what a start makes, nor ever afterwards: nearly all of it stays."""
    gc.disable()
    try:
        yield
        gc.freeze()
    finally:
        gc.enable()


def _say(line: str) -> None:
    """Print a line for programs, at once. A server with closed output goes on serving."""
    try:
        print(line, flush=True)  # noqa: T201 - what a command says to its user
    except OSError as error:  # a closed pipe, a full disk
        log.warning("cannot print %r: %s", line, error)
        give_up_stdout()
