"""The cases that the options of ``basu scenario run`` choose, with their samples and the user's files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from basu.scenarios.cases import cases_of, files_among, varied
from basu.scenarios.nhtsa import Group
from basu.scenarios.playable import having
from basu.scenarios.sampling import Grid, Sweep
from basu.scenarios.variation import Variation

if TYPE_CHECKING:
    from basu.running.scenario_runs.options import ScenarioOptions
    from basu.scenarios.playable import Playable
    from basu.scenarios.sampling import Design


def chosen(options: ScenarioOptions) -> tuple[Playable, ...]:
    """The requested cases in the order of the typology, with samples where requested.

    Raises:
        UserError: there is none of that name, or it cannot be sampled like this.
    """
    fixed = options.fixed if options.ego is None else (*options.fixed, ("ego", options.ego))
    variation = Variation(fixed=fixed, design=design_of(options), vary=options.vary)
    typology = list(Group)
    cases = having(cases_of(options.what, options.files), options.where)
    by_group = sorted(cases, key=lambda each: typology.index(each.scenario.group))
    return varied(by_group, variation)


def design_of(options: ScenarioOptions) -> Design | None:
    """How parameters are sampled; None: each case as it is given."""
    if options.grid is not None:
        return Grid(options.grid)
    return None if options.sweep is None else Sweep(options.sweep, options.seed)


def files_of(options: ScenarioOptions) -> tuple[Path, ...]:
    """The user's files: those named with --scenarios and those among what is to be played."""
    return (*options.files, *(Path(word) for word in files_among(options.what)))
