"""What a short job of a campaign costs beside its driving, in a worker that is warm.

    python benchmarks/job_cost.py [--jobs 12] [--agent basic]

The player of campaigns plays one case in this process with its simulator and its agent's process: drives of 20 ticks,
then of 220. A tick's cost is the slope between both. What is left of the short drive is the cost of a job:
the new world, the vehicle, the record, the verdict and the metrics. Processor time is of all processes together.
"""

from __future__ import annotations

import argparse
import os
import statistics
import tempfile
from pathlib import Path
from typing import Any

from basu.campaigns.campaign_run import RunSettings
from basu.campaigns.command import player_settings
from basu.campaigns.plan import CampaignPlan
from basu.campaigns.planning import plan_of
from basu.campaigns.player import open_player
from basu.campaigns.settings import checked
from basu.conditions import STEP_S

SCENARIO = Path(__file__).parents[1] / "examples" / "scenarios" / "bin_lorry"
GROUP = "    group = Group.REAR_END\n"
SHORT, LONG = 20, 220  # ticks
WARM = 2  # drives of each length before the measured ones


def plan_for(ticks: int, agent: str, jobs: int, folder: Path) -> CampaignPlan:
    """Drives of the example's case that end after so many ticks."""
    text = SCENARIO.with_suffix(".py").read_text()
    limit = f"    timeout_s = {(ticks - 1.5) * STEP_S:g}\n"  # it ends in the second tick after its limit
    folder.mkdir()
    (folder / "short.py").write_text(text.replace(GROUP, GROUP + limit))
    (folder / "short.xml").write_text(SCENARIO.with_suffix(".xml").read_text())
    drives = [{"cases": ["short.xml"]}]
    document = {"name": "cost", "agents": [agent], "seeds": {"number": jobs}, "drives": drives}
    return plan_of(checked(document, "the benchmark"), folder / "campaign.toml")


def rows_of(plan: CampaignPlan, jobs: int, folder: Path) -> list[dict[str, Any]]:
    """The rows of the first drives of a plan, played one after the other in one worker."""
    settings = player_settings(plan, folder, RunSettings(file=folder / "none.toml", output=folder))
    assert settings.scratch is not None
    settings.scratch.mkdir(parents=True, exist_ok=True)
    with open_player(settings) as play:
        return [play({**plan.job(number), "bar": 1.0}).value.row for number in range(jobs)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--jobs", type=int, default=12)
    parser.add_argument("--agent", default="basic")
    given = parser.parse_args()
    print(f"{len(os.sched_getaffinity(0))} processors, load {os.getloadavg()[0]:.1f}", flush=True)
    rows, found = dict[int, list[dict[str, Any]]](), dict[int, dict[str, float]]()
    with tempfile.TemporaryDirectory() as scratch:
        jobs = given.jobs + WARM
        for ticks in (SHORT, LONG):
            folder = Path(scratch) / str(ticks)
            rows[ticks] = rows_of(plan_for(ticks, given.agent, jobs, folder), jobs, folder)[WARM:]
    for ticks, each in rows.items():
        driven = {round(row["simulated_s"] / STEP_S) for row in each}
        if driven != {ticks}:
            raise SystemExit(f"drives of {ticks} ticks had {driven}; {each[0]['status']}: {each[0]['message']}")
        found[ticks] = {name: statistics.median(row[name] for row in each) for name in ("wall_s", "cpu_s")}
    print(f"{'median of ' + str(given.jobs):<34}{'wall s':>9}{'processor s':>14}")
    for ticks, cost in found.items():
        print(f"{'a job of ' + str(ticks) + ' ticks':<34}{cost['wall_s']:9.3f}{cost['cpu_s']:14.3f}")
    tick = {name: (found[LONG][name] - found[SHORT][name]) / (LONG - SHORT) for name in ("wall_s", "cpu_s")}
    print(f"{'a tick':<34}{tick['wall_s']:9.4f}{tick['cpu_s']:14.4f}")
    beside = {name: found[SHORT][name] - SHORT * tick[name] for name in tick}
    print(f"{'a job beside its driving':<34}{beside['wall_s']:9.3f}{beside['cpu_s']:14.3f}")


if __name__ == "__main__":
    main()
