"""``basu replay``: a run again, on a simulator or in Rerun's viewer."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable

from basu import plugins
from basu.cli.typed_options import options_of
from basu.errors import UserError
from basu.options.run import RunOptions
from basu_carla_log.recorder_log import progress_bar, read_recording
from basu_carla_log.server_replay import Progress, Where, play


def run(arguments: argparse.Namespace) -> int:
    """Play a run again: on a simulator, where any client can watch it, or with --viewer in Rerun's, without one."""
    if not arguments.speed >= 0.0:
        raise UserError(f"--speed is {arguments.speed}; it is a factor, or 0")
    if not arguments.viewer:
        return _on_simulator(arguments)
    viewer: Callable[[argparse.Namespace], int] = plugins.load(plugins.PARTS, "viewer_replay", "--viewer")
    return viewer(arguments)


def _on_simulator(arguments: argparse.Namespace) -> int:
    """The log on a simulator."""
    if arguments.save is not None or arguments.map is not None:
        raise UserError("--save and --map belong to --viewer; add it, or leave them out")
    log, _ = read_recording(arguments.recording, arguments.map)
    options = options_of(RunOptions, arguments)
    where = Where(options.host, options.port, options.timeout_s)
    with progress_bar(log.frames) as bar:

        def ready(address: str) -> None:
            bar.write(f"watch it at {address}, with any client of CARLA's", file=sys.stderr)

        play(log, where, speed=arguments.speed, progress=Progress(ready, bar.update))
    return 0
