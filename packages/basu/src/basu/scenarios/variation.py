"""Variants of a case, each with an id that is enough to make it again.

An id is the case's name and what was done to it, in this order, each behind a colon::

    roundabout_1                                    the case as its file has it
    roundabout_1:speed=6.5,gap=2                    with these values
    roundabout_1:sweep-200-7-13                     the 13th of a sweep of 200 with seed 7, over all parameters
    roundabout_1:gap=2:sweep-200-7-13               likewise, over all but `gap`
    roundabout_1:sweep-200-7-13:speed,offset        likewise, over `speed` and `offset`
    roundabout_1:grid-5-13:speed,offset             the 13th of a grid of 5 steps over them

What an id means depends on the scenario's declared ranges, or what its case leaves of them, and on nothing else.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from basu.errors import ScenarioError
from basu.scenarios.sampling import Design, Grid, Sweep, check_design, draw
from basu.scenarios.xml_elements import hint

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.scenarios.parameters import Parameter
    from basu.scenarios.xml_elements import Case

DESIGN = re.compile(r"(?:sweep-(?P<count>\d+)-(?P<seed>\d+)|grid-(?P<steps>\d+))-(?P<index>[1-9]\d*)")
SHAPE = "CASE[:NAME=VALUE,…][:sweep-N-SEED-INDEX or :grid-K-INDEX[:NAME,…]]"


@dataclass(frozen=True, slots=True, kw_only=True)
class Variation:
    """What is to be done to a case: `--set`, `--sweep` or `--grid`, `--vary`."""

    fixed: tuple[tuple[str, str], ...] = ()  # values by parameter, as text
    design: Design | None = None
    vary: tuple[str, ...] = ()  # only these; empty: all that are not fixed


def variants(case: Case, parameters: Sequence[Parameter], variation: Variation) -> tuple[Case, ...]:
    """All that a variation makes of a case: one where it has no design.

    Raises:
        ScenarioError: it names a parameter that is not there or twice, a value that is out of range, or makes too many.
    """
    fixed = _fixed(parameters, variation.fixed)
    name = ":".join([case.name, ",".join(f"{key}={text}" for key, text in fixed.items())]).rstrip(":")
    values = {**case.values, **fixed}
    if variation.design is None:
        if variation.vary:
            raise ScenarioError(
                f"--vary {','.join(variation.vary)} says what to change, not how; add --sweep or --grid"
            )
        return (replace(case, name=name, values=values),)
    design, varied = variation.design, _varied(case, parameters, fixed, variation.vary)
    check_design(design, varied)
    begin = (
        f"{name}:sweep-{design.samples}-{design.seed}" if isinstance(design, Sweep) else f"{name}:grid-{design.steps}"
    )
    end = ":" + ",".join(parameter.name for parameter in varied) if variation.vary else ""
    return tuple(
        replace(case, name=f"{begin}-{index}{end}", values={**values, **drawn})
        for index, drawn in enumerate(draw(design, varied), start=1)
    )


def parse_id(identity: str) -> tuple[str, Variation, int | None]:
    """The name of the case, what was done to it, and which of the design it is; None without a design.

    Raises:
        ScenarioError: what stands behind the case's name is none of this.
    """
    name, *rest = identity.split(":")
    fixed: tuple[tuple[str, str], ...] = ()
    if rest and "=" in rest[0]:
        pairs = [pair.partition("=") for pair in rest.pop(0).split(",")]
        fixed = tuple((key, text) for key, _, text in pairs)
    if not rest:
        return name, Variation(fixed=fixed), None
    found = DESIGN.fullmatch(rest[0])
    if found is None or len(rest) > 2:
        raise ScenarioError(f"the id '{identity}' cannot be read at '{':'.join(rest)}'; an id is {SHAPE}")
    design: Design = Grid(int(found["steps"])) if found["steps"] else Sweep(int(found["count"]), int(found["seed"]))
    vary = tuple(rest[1].split(",")) if len(rest) == 2 else ()
    return name, Variation(fixed=fixed, design=design, vary=vary), int(found["index"])


def variant(case: Case, parameters: Sequence[Parameter], identity: str) -> Case:
    """The one variant of a case that an id means.

    Raises:
        ScenarioError: it means none.
    """
    _, variation, index = parse_id(identity)
    made = variants(case, parameters, variation)
    if index is not None and index > len(made):
        raise ScenarioError(f"the id '{identity}' asks for number {index} of {len(made)}; the last is {made[-1].name}")
    return made[(index or 1) - 1]


def _fixed(parameters: Sequence[Parameter], given: Sequence[tuple[str, str]]) -> dict[str, str]:
    """The values that are set, in the order of declaration, each spelt in one way."""
    known = {parameter.name: parameter for parameter in parameters}
    texts: dict[str, str] = {}
    for name, text in given:
        if name not in known:
            raise ScenarioError(f"--set {name}={text}: there is no such parameter; {hint(name, known)}")
        if name in texts:
            raise ScenarioError(f"--set {name} is given twice; leave one")
        value = known[name].read(text)
        texts[name] = value if isinstance(value, str) else repr(value).removesuffix(".0")
    return {name: texts[name] for name in known if name in texts}


def _varied(
    case: Case, parameters: Sequence[Parameter], fixed: dict[str, str], wanted: Sequence[str]
) -> list[Parameter]:
    """The parameters that a design changes, in the order of declaration."""
    known = [parameter.name for parameter in parameters]
    for position, name in enumerate(wanted):
        if name not in known:
            raise ScenarioError(f"--vary {name}: {case.type} has no such parameter; {hint(name, known)}")
        if name in fixed or name in wanted[:position]:
            raise ScenarioError(f"--vary {name}: it is {'set' if name in fixed else 'named'} already; leave one")
    varied = [p for p in parameters if (p.name in wanted if wanted else p.name not in fixed)]
    if not varied:
        raise ScenarioError(f"{case.name}: {case.type} has no parameter left to change; drive it as it is")
    return varied
