"""Options of the simulator: a running one or our own, its maps, and how many at a time."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from basu.errors import UserError
from basu.settings.option import Settings, option


@dataclass(frozen=True, kw_only=True)
class SimulatorOptions(Settings):
    """The simulators of a command."""

    GROUP = "simulator"

    host: str | None = option(
        None, "a running simulator", metavar="HOST", default_text="start one and end it", repeats=False
    )
    port: int = option(2000, "port of --host", least=1, most=65_535, repeats=False)
    timeout_s: float = option(20.0, "time to wait for the simulator's answer", above=0.0, repeats=False)
    workers: int = option(
        1, "runs that are driven at the same time, each in a simulator of its own", least=1, repeats=False
    )
    maps: tuple[Path, ...] = option(
        (), "offer every .xodr of a folder as a map; may be given several times", metavar="DIR"
    )
    upload_map: Path | None = option(
        None,
        "send this OpenDRIVE map to the simulator at --host; routes of its town are driven there",
        metavar="FILE.xodr",
        repeats=False,
    )

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
