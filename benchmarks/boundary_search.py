"""How well samplers find failures and their boundary, on regions that are known.

usage: boundary_search.py [--seeds N] [--drives N] [--regions tuning|held-out] [--samplers NAME ...] [--flat]

No simulator is needed. Every sampler gets the same number of drives: 10 first, then rounds of 4 from one state of
knowledge. ``failures`` is the mean number found; ``any`` the share of seeds in which one was found. ``wrong`` is the
share of the space, and ``missed`` that of the failing region, on whose verdict the report's surrogate is wrong after
these drives, whatever sampler chose them. ``off`` counts drives that the surrogate puts on the wrong side. Intervals
are 95 % of a mean. With ``--flat`` severity leads nowhere. Optuna and BoTorch are not in any extra:
`pip install optuna botorch`.
"""
# ruff: noqa: ARG001, E402, FBT001, PLC0415 - samplers have one signature; threads are set, and libraries may be absent

import argparse
import importlib.util
import os
import sys
import warnings
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from basu.campaigns.settings import Search
from basu_search.rounds import round_sizes, space_filling
from basu_search.surrogate import SeveritySurrogate, Surrogate
from boundary_regions import HELD_OUT, TUNING, Gap, Points, known_of, searched

REGIONS = {"tuning": TUNING, "held-out": HELD_OUT}
FIRST, BATCH = 10, 4
FIRST_SEED = {"tuning": 0, "held-out": 10_000}
Sampler = Callable[[int, Gap, int, int, bool], Points]


def random(dimensions: int, gap: Gap, drives: int, seed: int, leads: bool) -> Points:
    return np.random.default_rng(seed).random((drives, dimensions))


def sobol(dimensions: int, gap: Gap, drives: int, seed: int, leads: bool) -> Points:
    return space_filling(drives, dimensions, seed)


def ours(dimensions: int, gap: Gap, drives: int, seed: int, leads: bool) -> Points:
    return searched(Search(drives=drives, first=FIRST, batch=BATCH), dimensions, gap, seed, leads=leads)


def straddle(dimensions: int, gap: Gap, drives: int, seed: int, leads: bool) -> Points:
    """Bryan et al. 2005: 1.96 deviations less the distance to the boundary; each fourth drive fills the space."""
    points, at = space_filling(FIRST, dimensions, seed), space_filling(1024, dimensions, seed + 1)
    while len(points) < drives:
        known = known_of(points, gap, leads=leads)
        failed = known.failed > 0.5
        away = np.linalg.norm(at[:, None] - points[None], axis=2).min(axis=1)
        made: list[Points] = []
        model = Surrogate(points, failed) if failed.any() and not failed.all() else None
        upper = None
        if model is None and np.ptp(known.severity) > 0.0:
            upper = SeveritySurrogate(points, known.severity).upper(at)
        for place in range(min(BATCH, drives - len(points))):
            worth = away
            if place != BATCH - 1 and model is not None:
                mean, deviation = model.latent(at)
                worth = 1.96 * deviation - np.abs(mean)
            elif place != BATCH - 1 and upper is not None:
                worth = upper
            chosen = at[int(np.argmax(np.where(away >= 0.01, worth, -np.inf)))]
            made.append(chosen)
            away = np.minimum(away, np.linalg.norm(at - chosen, axis=1))
            model = None if model is None else model.believing(chosen)
        points = np.vstack([points, made])
    return points


def _optuna(sampler: object, dimensions: int, gap: Gap, drives: int, leads: bool) -> Points:
    """Return the trials of a study that looks for the most severe drive, asked for and answered in rounds."""
    import optuna

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    study = optuna.create_study(direction="maximize", sampler=sampler)
    space = {f"x{axis}": optuna.distributions.FloatDistribution(0.0, 1.0) for axis in range(dimensions)}
    points = np.empty((0, dimensions))
    for size in round_sizes(FIRST, drives, BATCH):
        trials = [study.ask(space) for _ in range(size)]
        made = np.array([[trial.params[name] for name in space] for trial in trials])
        for trial, severity in zip(trials, known_of(made, gap, leads=leads).severity, strict=True):
            study.tell(trial, float(severity))
        points = np.vstack([points, made])
    return points


def optuna_tpe(dimensions: int, gap: Gap, drives: int, seed: int, leads: bool) -> Points:
    import optuna

    sampler = optuna.samplers.TPESampler(n_startup_trials=FIRST, multivariate=True, constant_liar=True, seed=seed)
    return _optuna(sampler, dimensions, gap, drives, leads)


def optuna_gp(dimensions: int, gap: Gap, drives: int, seed: int, leads: bool) -> Points:
    import optuna

    warnings.simplefilter("ignore", optuna.exceptions.ExperimentalWarning)
    sampler = optuna.samplers.GPSampler(n_startup_trials=FIRST, seed=seed, deterministic_objective=True)
    return _optuna(sampler, dimensions, gap, drives, leads)


def botorch_ei(dimensions: int, gap: Gap, drives: int, seed: int, leads: bool) -> Points:
    """Log expected improvement of severity, several drives at once, among the candidates of a Sobol sequence."""
    import torch
    from botorch.acquisition import qLogExpectedImprovement
    from botorch.fit import fit_gpytorch_mll
    from botorch.models import SingleTaskGP
    from botorch.optim import optimize_acqf_discrete
    from botorch.sampling import SobolQMCNormalSampler
    from gpytorch.mlls import ExactMarginalLogLikelihood

    torch.set_num_threads(1)
    torch.manual_seed(seed)
    points, at = space_filling(FIRST, dimensions, seed), torch.tensor(space_filling(1024, dimensions, seed + 1))
    while len(points) < drives:
        severity = torch.tensor(known_of(points, gap, leads=leads).severity)[:, None]
        if float(np.ptp(severity)) == 0.0:
            points = space_filling(len(points) + min(BATCH, drives - len(points)), dimensions, seed)
            continue
        model = SingleTaskGP(torch.tensor(points), severity)
        fit_gpytorch_mll(ExactMarginalLogLikelihood(model.likelihood, model))
        worth = qLogExpectedImprovement(model, severity.max(), SobolQMCNormalSampler(torch.Size([64]), seed=seed))
        made, _ = optimize_acqf_discrete(worth, min(BATCH, drives - len(points)), at, unique=True)
        points = np.vstack([points, made.numpy()])
    return points


SAMPLERS: dict[str, Sampler] = {
    "random": random,
    "sobol": sobol,
    "ours": ours,
    "straddle": straddle,
    "optuna-tpe": optuna_tpe,
    "optuna-gp": optuna_gp,
    "botorch-ei": botorch_ei,
}


def result(task: tuple[str, str, str, int, int, bool]) -> tuple[float, float, float, float]:
    """Failures, wrong share of the space, missed share of the failing region, and drives on the wrong side."""
    kind, name, sampler, drives, seed, leads = task
    region = REGIONS[kind][name]
    gap = region.gap(seed)
    points = SAMPLERS[sampler](region.dimensions, gap, drives, seed, leads)
    assert len(points) == drives, "every sampler gets the same number"
    failed, at = gap(points) < 0.0, space_filling(4096, region.dimensions, 99)
    fails, said, off = gap(at) < 0.0, np.full(len(at), failed.all()), 0.0
    if failed.any() and not failed.all():
        surrogate = Surrogate(points, failed)
        said = surrogate.failing(at) > 0.5
        off = float(((surrogate.failing(points) > 0.5) != failed).sum())
    return float(failed.sum()), float((said != fails).mean()), float((~said[fails]).mean()), off


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--drives", type=int, default=26)
    parser.add_argument("--regions", choices=list(REGIONS), default="held-out")
    parser.add_argument("--samplers", nargs="+", choices=list(SAMPLERS), default=list(SAMPLERS))
    parser.add_argument("--flat", action="store_true")
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args()
    samplers = []
    for sampler in given.samplers:
        library = sampler.split("-")[0]
        if library in {"optuna", "botorch"} and importlib.util.find_spec(library) is None:
            print(f"{sampler} is left out: install it with `pip install {library}`")
        else:
            samplers.append(sampler)
    print(f"{given.regions} regions, {given.seeds} seeds, {given.drives} drives, "
          f"severity {'flat' if given.flat else 'leads'}")  # fmt: skip
    print(
        f"{'region':<27} {'sampler':<11} {'failures':>12} {'any, %':>7} {'wrong, %':>13} {'missed, %':>13} {'off':>4}"
    )
    first, totals = FIRST_SEED[given.regions], {sampler: [] for sampler in samplers}
    with ProcessPoolExecutor(given.workers) as pool:
        for name in REGIONS[given.regions]:
            for sampler in samplers:
                tasks = [(given.regions, name, sampler, given.drives, first + seed, not given.flat)
                         for seed in range(given.seeds)]  # fmt: skip
                totals[sampler].append(found := np.array(list(pool.map(result, tasks))))
                print(f"{name:<27} {line(sampler, found)}", flush=True)
    for sampler, found in totals.items():
        print(f"{'all':<27} {line(sampler, np.concatenate(found))}")
    for sampler in [each for each in samplers if each != "ours" and "ours" in samplers]:
        less = np.concatenate(totals["ours"]) - np.concatenate(totals[sampler])  # the same places, pair by pair
        mean, half = less.mean(axis=0), 1.96 * less.std(axis=0, ddof=1) / np.sqrt(len(less))
        print(f"ours less {sampler}: failures {mean[0]:+.1f} ± {half[0]:.1f}, wrong {100.0 * mean[1]:+.1f} ± "
              f"{100.0 * half[1]:.1f} %, missed {100.0 * mean[2]:+.1f} ± {100.0 * half[2]:.1f} %")  # fmt: skip


def line(sampler: str, found: Points) -> str:
    """A sampler's row."""
    means, halves = found.mean(axis=0), 1.96 * found.std(axis=0, ddof=1) / np.sqrt(len(found))
    figures = f"{means[0]:>5.1f} ± {halves[0]:>4.1f} {(found[:, 0] > 0).mean():>7.0%}"
    for column in (1, 2):
        figures += f" {100.0 * means[column]:>6.1f} ± {100.0 * halves[column]:>4.1f}"
    return f"{sampler:<11} {figures} {found[:, 3].sum():>4.0f}"


if __name__ == "__main__":
    main()
