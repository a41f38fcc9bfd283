"""Options of the simulator: a running one or our own, its maps, and how many at a time."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from basu.errors import UserError
from basu.options.groups import SIMULATOR
from basu.settings.option import Option, Settings


@dataclass(frozen=True, kw_only=True)
class SimulatorOptions(Settings):
    """The simulators of a command."""

    host: Annotated[
        str | None,
        Option(
            help="a running simulator",
            group=SIMULATOR,
            metavar="HOST",
            default_text="start one and end it",
            repeats=False,
        ),
    ] = None
    port: Annotated[
        int, Option(help="port of --host", group=SIMULATOR, metavar="N", least=1, most=65_535, repeats=False)
    ] = 2000
    timeout_s: Annotated[
        float,
        Option(
            help="time to wait for the simulator's answer",
            group=SIMULATOR,
            flag="--timeout",
            metavar="S",
            unit="s",
            above=0.0,
            repeats=False,
        ),
    ] = 20.0
    workers: Annotated[
        int,
        Option(
            help="runs that are driven at the same time, each in a simulator of its own",
            group=SIMULATOR,
            metavar="N",
            least=1,
            repeats=False,
        ),
    ] = 1
    maps: Annotated[
        tuple[Path, ...],
        Option(
            help="offer every .xodr of a folder as a map; may be given several times",
            group=SIMULATOR,
            metavar="DIR",
            is_file=True,
        ),
    ] = ()
    upload_map: Annotated[
        Path | None,
        Option(
            help="send this OpenDRIVE map to the simulator at --host; routes of its town are driven there",
            group=SIMULATOR,
            metavar="FILE.xodr",
            is_file=True,
            repeats=False,
        ),
    ] = None

    def check(self) -> None:
        """Check the options of maps.

        Raises:
            UserError: one is none, or the simulator is not ours.
        """
        if self.maps and self.host is not None:
            raise UserError(
                "--maps is for the simulator that basu starts; give that at --host its own: `linden serve --maps DIR`"
            )
        if self.upload_map is not None and self.host is None:
            raise UserError(
                "--upload-map sends a map to the simulator at --host; without --host, --maps DIR offers a folder's maps"
            )
        for folder in self.maps:
            if not folder.is_dir():
                raise UserError(
                    f"--maps {folder} is no folder; name the one that `linden map build` writes .xodr files to"
                )
        super().check()
