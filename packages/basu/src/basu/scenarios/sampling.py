"""Values for parameters: a Latin hypercube or a grid over their ranges, the same for the same seed on every machine.

Latin hypercube: McKay, Beckman, Conover 1979, "A comparison of three methods for selecting values of input variables".
Each number's range is cut into as many equal strata as there are samples, and each stratum is met once. All chance is
``random.Random.random``, which Python promises to keep ("Notes on Reproducibility"); each parameter has a stream of its
own, so that its values do not change with what else is varied.
"""

from __future__ import annotations

import math
import random
from typing import TYPE_CHECKING, NamedTuple

from basu.errors import ScenarioError
from basu.scenarios.parameters import Number

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.scenarios.parameters import Parameter

LIMIT = 10_000  # of cases in one design: at a second each, three hours
FINENESS = 1_000  # places within a stratum


class Sweep(NamedTuple):
    """A Latin hypercube of ``samples`` cases."""

    samples: int
    seed: int

    def size(self, _parameters: Sequence[Parameter]) -> int:
        """How many cases it makes of one."""
        return self.samples


class Grid(NamedTuple):
    """``steps`` values of each number, from the lowest to the highest, by every option of each choice."""

    steps: int

    def size(self, parameters: Sequence[Parameter]) -> int:
        """How many cases it makes of one."""
        return math.prod(self.steps if isinstance(p, Number) else len(p.options) for p in parameters)


Design = Sweep | Grid


def check_design(design: Design, parameters: Sequence[Parameter]) -> None:
    """Pass a design that can be driven.

    Raises:
        ScenarioError: it has too few steps or makes too many cases.
    """
    if isinstance(design, Sweep) and design.samples < 1:
        raise ScenarioError(f"a sweep of {design.samples} is none; name a number of samples from 1 to {LIMIT}")
    if isinstance(design, Sweep) and design.seed < 0:
        raise ScenarioError(f"the seed of a sweep is {design.seed}; it must be 0 or more")
    if isinstance(design, Grid) and design.steps < 2:
        raise ScenarioError(f"a grid of {design.steps} is none; 2 steps are the lowest and the highest value of each")
    size = design.size(parameters)
    if size > LIMIT:
        over = f"of {len(parameters)} parameters ({', '.join(p.name for p in parameters)}) " * isinstance(design, Grid)
        raise ScenarioError(
            f"{type(design).__name__.lower()} {over}has {size:,} cases and may have {LIMIT:,}; "
            "take fewer, or name with --vary what is to change"
        )


def draw(design: Design, parameters: Sequence[Parameter]) -> list[dict[str, str]]:
    """The values of every case of a design, as text, in its order; those with the last parameter changing fastest."""
    if isinstance(design, Sweep):
        columns = [_sampled(parameter, design) for parameter in parameters]
    else:
        columns = _crossed([_stepped(parameter, design) for parameter in parameters])
    names = [parameter.name for parameter in parameters]
    return [dict(zip(names, row, strict=True)) for row in zip(*columns, strict=True)]


def _sampled(parameter: Parameter, sweep: Sweep) -> list[str]:
    """One value for each sample."""
    rng = random.Random(f"{sweep.seed} {parameter.name}")  # noqa: S311 - to be repeated, not to be secret
    strata = list(range(sweep.samples))
    for last in range(sweep.samples - 1, 0, -1):  # Fisher and Yates: of random() alone, as shuffle() may change
        other = int(rng.random() * (last + 1))
        strata[last], strata[other] = strata[other], strata[last]
    if not isinstance(parameter, Number):
        options = parameter.options
        return [options[stratum * len(options) // sweep.samples] for stratum in strata]
    within = [(int(rng.random() * FINENESS) + 0.5) / FINENESS for _ in strata]
    return [_within(parameter, stratum, sweep.samples, share) for stratum, share in zip(strata, within, strict=True)]


def _within(number: Number, stratum: int, strata: int, share: float) -> str:
    """The value so far along a stratum, in no more digits than keep it there."""
    width = (number.high - number.low) / strata
    digits = max(0, math.ceil(-math.log10(width / FINENESS / 2)))
    return f"{number.low + (stratum + share) * width:.{digits}f}"


def _stepped(parameter: Parameter, grid: Grid) -> list[str]:
    """The values of one parameter."""
    if not isinstance(parameter, Number):
        return list(parameter.options)
    step = (parameter.high - parameter.low) / (grid.steps - 1)
    return [_text(parameter, parameter.low + index * step) for index in range(grid.steps)]


def _text(number: Number, value: float) -> str:
    """A value without the last digits of its arithmetic, unless they hold it within the range."""
    text = f"{value:.10g}"
    return text if number.low <= float(text) <= number.high else repr(min(max(value, number.low), number.high))


def _crossed(columns: list[list[str]]) -> list[list[str]]:
    """Every combination, one list a parameter."""
    total = math.prod(len(column) for column in columns)
    crossed, repeat = [], total
    for column in columns:
        repeat //= len(column)
        crossed.append([column[index // repeat % len(column)] for index in range(total)])
    return crossed
