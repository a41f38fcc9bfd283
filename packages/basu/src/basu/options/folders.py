"""Options of what a run leaves: its folder, records, bags, topics and series."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

from basu.errors import UserError
from basu.options.groups import FOLDERS
from basu.settings.option import Option, Settings, suggestion

SCORES = ("driving", "infraction", "path_following")  # of the thesis, equations 5.1 to 5.5


@dataclass(frozen=True, kw_only=True)
class RecordOptions(Settings):
    """The metrics, records and folders of a drive."""

    metric_files: Annotated[
        tuple[Path, ...],
        Option(
            help="metrics of your own, reported beside BASU's or scored with them; may be given several times",
            group=FOLDERS,
            flag="--metrics",
            metavar="FILE.py",
            is_file=True,
        ),
    ] = ()
    record: Annotated[bool, Option(help="let the simulator write CARLA's log, recording.log", group=FOLDERS)] = False
    rosbag: Annotated[
        Literal["ros2", "ros1"] | None,
        Option(
            help="write sensors, state, control and TF as a ROS bag: a folder with MCAP for ros2, a .bag for ros1; "
            "without a word: ros2",
            group=FOLDERS,
            bare="ros2",
            default_text="write none",
            advice="an agent is named before --rosbag, as in `basu run basic --rosbag`",
        ),
    ] = None
    ros2: Annotated[
        bool,
        Option(
            help="publish the run on ROS 2 while it lasts, over DDS, in the domain of ROS_DOMAIN_ID",
            group=FOLDERS,
            repeats=False,
        ),
    ] = False
    ros1: Annotated[
        bool,
        Option(
            help="publish the run on ROS 1 while it lasts, at the roscore of ROS_MASTER_URI",
            group=FOLDERS,
            repeats=False,
        ),
    ] = False
    output: Annotated[Path, Option(help="parent of the run folders", group=FOLDERS, metavar="DIR", repeats=False)] = (
        Path("runs")
    )


@dataclass(frozen=True, kw_only=True)
class SeriesOptions(Settings):
    """The series of runs, and the scores that a run needs."""

    require: Annotated[
        Mapping[str, float],
        Option(
            help="least score that a run needs for the exit status 0; may be given several times",
            group=FOLDERS,
            metavar="SCORE=LEAST",
            least=0.0,
            most=1.0,
            default_text="none",
            repeats=False,
        ),
    ] = field(default_factory=lambda: dict.fromkeys(SCORES, 0.0))
    details: Annotated[
        bool,
        Option(
            help="print the figures of all metrics and the editions of CARLA's leaderboard as well",
            group=FOLDERS,
            repeats=False,
        ),
    ] = False
    series: Annotated[
        str | None,
        Option(
            help="keep all runs in a folder of this name, with their totals in series.json",
            group=FOLDERS,
            metavar="NAME",
            repeats=False,
        ),
    ] = None
    resume: Annotated[
        bool,
        Option(
            help="continue an interrupted --series, or without one the same command after it was killed",
            group=FOLDERS,
            repeats=False,
        ),
    ] = False

    def check(self) -> None:
        """Check the required scores.

        Raises:
            UserError: there is no such score.
        """
        unknown = next((name for name in self.require if name not in SCORES), None)
        if unknown is not None:
            raise UserError(f"--require {unknown}: there is no such score; {suggestion(unknown, SCORES)}")
        super().check()
