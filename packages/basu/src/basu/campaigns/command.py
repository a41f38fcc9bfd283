"""`basu campaign run`: sets up lock, plan, table and workers for `CampaignRun`; `describe` prints the dry run."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from basu.campaigns.campaign_folder import CAMPAIGN_FILE, SCRATCH, begin
from basu.campaigns.campaign_run import CampaignRun, RunSettings
from basu.campaigns.columns import schema_of
from basu.campaigns.drive_table import DriveTable
from basu.campaigns.planning import plan_of
from basu.campaigns.player import PlayerSettings, drive_player
from basu.campaigns.settings import read_campaign
from basu.campaigns.storage import Mirror, Store, fetch
from basu.errors import UserError
from basu.jobs.pool import Pool
from basu.jobs.processes import Processes
from basu.running.folder_lock import locked

if TYPE_CHECKING:
    from pathlib import Path

    from basu.campaigns.plan import CampaignPlan
    from basu.jobs.job import PlayerSpec
    from basu.jobs.pool import Backend


def run_campaign(settings: RunSettings) -> int:
    """Drive a campaign, or go on with it; the exit code is 130 where it was interrupted.

    Raises:
        UserError: it cannot be driven like this; said before anything is driven. Or the disk is full.
        SimulatorError: there is no simulator to drive in.
    """
    plan = plan_of(read_campaign(settings.file), settings.file)
    folder = settings.output / plan.campaign.name
    schema = schema_of(plan.parameters(), plan.metric_files)
    store = None if settings.store is None else Store(f"{settings.store.rstrip('/')}/{plan.campaign.name}")
    with locked(folder):
        if store is not None:
            _take_up_store(store, folder, resume=settings.resume)
        backend, workers = _backend(settings, drive_player(player_settings(plan, folder, settings)))
        begin(folder, plan, settings.file, resume=settings.resume)
        table = DriveTable(folder, schema, plan.campaign.block, plan.size)
        run = CampaignRun(plan, folder, table, settings, None if store is None else Mirror(folder, store))
        pool = Pool(
            backend,
            max(1, min(workers, run.limit - run.table.number)),
            attempts=plan.campaign.work.attempts,
            job_limit_s=plan.campaign.work.drive_limit_s,
        )
        return run.drive_all(pool)


def describe(file: Path) -> str:
    """What a campaign would drive, in lines.

    Raises:
        UserError: it cannot be driven.
    """
    plan = plan_of(read_campaign(file), file)
    lines = [
        f"campaign  {plan.campaign.name}",
        f"agents    {', '.join(f'{agent.name} (track {agent.group})' for agent in plan.agents)}",
    ]
    for part in plan.parts:
        names = list(dict.fromkeys(subject.name for subject in part.subjects))
        shown = ", ".join(names[:5]) + (f" and {len(names) - 5} more" if len(names) > 5 else "")
        over = f"{len(part.traffic)} traffics, {part.seeds.number} seeds"
        if part.search is not None:
            numbers = ", ".join(dict.fromkeys(each.name for space in part.search.spaces for each in space))
            over = f"{part.seeds.number} seeds, {sum(part.search.sizes)} drives of a search over {numbers}"
        lines.append(
            f"drives    {shown}: {len(part.subjects)} variants, {len(part.weather)} weathers, {over}: "
            f"{part.size} conditions"
        )
    lines += _same_drives(plan)
    return "\n".join([*lines, f"in all    {plan.conditions} conditions, {plan.size} drives"])


def _same_drives(plan: CampaignPlan) -> list[str]:
    """Return a warning for each [[drives]] in which seeds change nothing but an agent's own draws."""
    return [
        f"warning   {part.subjects[0].name}: its {part.seeds.number} seeds change nothing in the world, since there is "
        "no random traffic. If the agent draws nothing at random, all but one are the same drive and count once; take "
        "a larger sweep and one seed"
        for part in plan.parts
        if part.seeds.number > 1
        and not any(other.vehicles or other.walkers or other.density_per_km for other in part.traffic)
    ]


def player_settings(plan: CampaignPlan, folder: Path, settings: RunSettings) -> PlayerSettings:
    """What all drives of a campaign in ``folder`` share."""
    campaign = plan.campaign
    return PlayerSettings(
        agents=tuple(agent.typed for agent in plan.agents),
        scoring=plan.scoring,
        vehicle=campaign.vehicle,
        open=campaign.open,
        step_limit_s=campaign.step_limit_s,
        agent_memory_gb=campaign.agent_memory_gb,
        agent_writes=campaign.agent_writes,
        scenario_files=plan.scenario_files,
        metric_files=plan.metric_files,
        sample=campaign.keep.sample,
        scratch=(folder / SCRATCH).resolve() if settings.ray is None else None,
    )


def _backend(settings: RunSettings, player: PlayerSpec) -> tuple[Backend[Any], int]:
    """The workers and how many of them.

    Raises:
        UserError: the cluster is not there.
    """
    if settings.ray is not None:
        from basu.jobs.cluster import RayBackend  # noqa: PLC0415 - Ray, which is an extra

        cluster = RayBackend(player, settings.ray)
        return cluster, settings.workers or cluster.processors()
    return Processes(player), settings.workers or len(os.sched_getaffinity(0))


def _take_up_store(store: Store, folder: Path, *, resume: bool) -> None:
    """Fetch a campaign that goes on where this machine has no folder of it.

    Raises:
        UserError: the store has a campaign already, or none to go on with, or refuses.
    """
    is_there = CAMPAIGN_FILE in store.names()
    if is_there and not resume:
        raise UserError(
            f"{store.address} holds a campaign already; add --resume to go on with it, or name another place with "
            "--output"
        )
    if is_there and not (folder / CAMPAIGN_FILE).exists():
        fetch(store, folder)
