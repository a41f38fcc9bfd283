"""Options of what a run leaves: its folder, records, bags, topics and series."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from basu.errors import UserError
from basu.settings.option import Settings, option, suggestion

SCORES = ("driving", "infraction", "path_following")  # of the thesis, equations 5.1 to 5.5


@dataclass(frozen=True, kw_only=True)
class RecordOptions(Settings):
    """The metrics, records and folders of a drive."""

    GROUP = "run folders"

    metric_files: tuple[Path, ...] = option(
        (),
        "metrics of your own, reported beside BASU's or scored with them; may be given several times",
        flag="--metrics",
        metavar="FILE.py",
    )
    record: bool = option(False, "let the simulator write CARLA's log, recording.log")
    rosbag: Literal["ros2", "ros1"] | None = option(
        None,
        "write sensors, state, control and TF as a ROS bag: a folder with MCAP for ros2, a .bag for ros1; "
        "without a word: ros2",
        bare="ros2",
        default_text="write none",
        advice="an agent is named before --rosbag, as in `basu run basic --rosbag`",
    )
    ros2: bool = option(
        False, "publish the run on ROS 2 while it lasts, over DDS, in the domain of ROS_DOMAIN_ID", repeats=False
    )
    ros1: bool = option(
        False, "publish the run on ROS 1 while it lasts, at the roscore of ROS_MASTER_URI", repeats=False
    )
    output: Path = option(Path("runs"), "parent of the run folders", metavar="DIR", repeats=False)


@dataclass(frozen=True, kw_only=True)
class SeriesOptions(Settings):
    """The series of runs, and the scores that a run needs."""

    GROUP = "run folders"

    require: Mapping[str, float] = option(
        dict.fromkeys(SCORES, 0.0),
        "least score that a run needs for the exit status 0; may be given several times",
        metavar="SCORE=LEAST",
        least=0.0,
        most=1.0,
        default_text="none",
        repeats=False,
    )
    details: bool = option(
        False,
        "print the figures of all metrics and the editions of CARLA's leaderboard as well",
        repeats=False,
    )
    series: str | None = option(
        None, "keep all runs in a folder of this name, with their totals in series.json", metavar="NAME", repeats=False
    )
    resume: bool = option(
        False, "continue an interrupted --series, or without one the same command after it was killed", repeats=False
    )

    def check(self) -> None:
        """Check the required scores.

        Raises:
            UserError: there is no such score.
        """
        unknown = next((name for name in self.require if name not in SCORES), None)
        if unknown is not None:
            raise UserError(f"--require {unknown}: there is no such score; {suggestion(unknown, SCORES)}")
        super().check()
