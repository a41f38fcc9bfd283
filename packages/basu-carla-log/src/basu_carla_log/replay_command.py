"""``basu replay``: a run's recorder file again, on a simulator."""

from __future__ import annotations

import argparse
import sys

from basu.cli.typed_options import options_of
from basu.errors import UserError
from basu.options.run import RunOptions
from basu_carla_log.recorder_log import progress_bar, read_recording
from basu_carla_log.server_replay import Progress, Where, play


def run(arguments: argparse.Namespace) -> int:
    """Play a run again on a simulator, where any client can watch it."""
    if not arguments.speed >= 0.0:
        raise UserError(f"--speed is {arguments.speed}; it is a factor, or 0")
    log, _ = read_recording(arguments.recording, None)
    options = options_of(RunOptions, arguments)
    where = Where(options.host, options.port, options.timeout_s)
    with progress_bar(log.frames) as bar:

        def ready(address: str) -> None:
            bar.write(f"watch it at {address}, with any client of CARLA's", file=sys.stderr)

        play(log, where, speed=arguments.speed, progress=Progress(ready, bar.update))
    return 0
