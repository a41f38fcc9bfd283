"""The cases that the options of ``basu scenario run`` choose, with their samples and the user's files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from basu.scenarios.cases import cases_of, files_among, open_library, varied
from basu.scenarios.nhtsa import Group
from basu.scenarios.playable import having
from basu.scenarios.sampling import Grid, Sweep
from basu.scenarios.suites.suite import suite_names
from basu.scenarios.variation import Variation

if TYPE_CHECKING:
    from collections.abc import Collection

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
    cases = having(cases_of(options.what, options.files, options.parameters), options.where)
    by_group = sorted(cases, key=lambda each: typology.index(each.scenario.group))
    return varied(by_group, variation)


def suites_of(options: ScenarioOptions, played: Collection[str]) -> list[dict[str, Any]]:
    """Return the documents of the requested suites, with the cases of each requirement that are ``played``.

    Raises:
        UserError: a file of the user cannot be used.
    """
    wanted = [word for word in options.what if word in suite_names()]
    if not wanted:
        return []
    library, found = open_library([*options.files, *files_among(options.what)], options.parameters), []
    for word in wanted:
        suite, cases = library.suite(word)
        document = suite.document()
        for requirement, (_, playables) in zip(document["requirements"], cases, strict=True):
            requirement["cases"] = [one.case.name for one in playables if one.case.name in played]
        found.append(document)
    return found


def design_of(options: ScenarioOptions) -> Design | None:
    """How parameters are sampled; None: each case as it is given."""
    if options.grid is not None:
        return Grid(options.grid)
    return None if options.sweep is None else Sweep(options.sweep, options.seed)


def files_of(options: ScenarioOptions) -> tuple[Path, ...]:
    """The user's files: those named with --scenarios and those among what is to be played."""
    return (*options.files, *(Path(word) for word in files_among(options.what)))
