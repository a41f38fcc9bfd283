"""Files with a ``ParameterValueDistribution``: values of parameters for many runs of one scenario file.

A deterministic distribution gives all combinations, in the order of the file, the last parameter changing fastest. A
stochastic one gives as many draws as it says. Each parameter has a generator from the file's seed and its own name. The
draws of one do not depend on the others.
"""

from __future__ import annotations

import itertools
import math
import random
from typing import TYPE_CHECKING, NamedTuple

from basu_openscenario.reading.xml_node import read_xml

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from basu_openscenario.reading.xml_node import Node

MOST_RUNS = 10_000
"""More runs than that are refused: a file with a small step is a mistake more often than a wish."""
MOST_TRIES = 10_000
"""A distribution with a range is drawn from again, at most so often, until the draw lies inside."""
DIGITS = 9
"""Of drawn values and of steps, so that 0.1 + 0.2 is 0.3."""

Assignment = dict[str, str]
"""Values of parameters by name, as a file has them."""


class Distribution(NamedTuple):
    """A scenario file, and the values of its parameters for each run."""

    scenario: Path
    runs: tuple[Assignment, ...]


def read_distribution(path: Path) -> Distribution | None:
    """Return the runs of a file; None where it has no distribution.

    Raises:
        ScenarioError: the file is broken, or asks for what is not supported.
    """
    root = read_xml(path, "OpenSCENARIO")
    node = root.find("ParameterValueDistribution")
    if node is None:
        return None
    file = node.child("ScenarioFile")
    scenario = (path.parent / file.text("filepath")).resolve()
    if not scenario.is_file():
        raise file.fault(f"the scenario {scenario} does not exist; correct its path")
    kind = node.only("ScenarioFile")
    if kind.tag == "Deterministic":
        runs = _deterministic(kind)
    elif kind.tag == "Stochastic":
        runs = _stochastic(kind)
    else:
        raise kind.fault(f"<{kind.tag}> is no distribution; write Deterministic or Stochastic")
    return Distribution(scenario, runs)


# deterministic ----------------------------------------------------------------------------------------------------


def _deterministic(node: Node) -> tuple[Assignment, ...]:
    """Return all combinations of the values of all parameters."""
    axes = [_axis(one) for one in node.children()]
    count = math.prod(len(axis) for axis in axes)
    if not axes or not 0 < count <= MOST_RUNS:
        raise node.fault(f"the distribution has {count if axes else 0} runs; give 1 to {MOST_RUNS}")
    combinations = itertools.product(*axes)
    return tuple({name: value for part in parts for name, value in part.items()} for parts in combinations)


def _axis(node: Node) -> list[Assignment]:
    """Return the values of one parameter, or of several that change together."""
    inside = node.only()
    if node.tag == "DeterministicMultiParameterDistribution" and inside.tag == "ValueSetDistribution":
        return [
            {one.text("parameterRef").lstrip("$"): one.text("value") for one in each.children("ParameterAssignment")}
            for each in inside.children("ParameterValueSet")
        ]
    if node.tag != "DeterministicSingleParameterDistribution":
        raise node.fault(f"<{node.tag}> is not supported as a deterministic distribution")
    name = node.text("parameterName")
    if inside.tag == "DistributionSet":
        return [{name: one.text("value")} for one in inside.children("Element")]
    if inside.tag == "DistributionRange":
        return [{name: _text(value)} for value in _steps(inside)]
    raise inside.fault(f"<{inside.tag}> is not supported; write a DistributionSet or a DistributionRange")


def _steps(node: Node) -> list[float]:
    """Return the values of a range with its steps, from its lower limit on."""
    low, high = _limits(node.child("Range"))
    step = node.number("stepWidth")
    count = (high - low) / step if step > 0.0 else math.inf
    if not count < MOST_RUNS:
        raise node.fault(f"steps of {step:g} from {low:g} to {high:g} are too many; give fewer than {MOST_RUNS}")
    return [low + nth * step for nth in range(math.floor(count + 1e-9) + 1)]


def _limits(node: Node) -> tuple[float, float]:
    """Return the limits of a range."""
    low, high = node.number("lowerLimit"), node.number("upperLimit")
    if not low <= high or math.isinf(low) or math.isinf(high):
        raise node.fault(f"the range from {low:g} to {high:g} is empty or endless; correct its limits")
    return low, high


# stochastic -------------------------------------------------------------------------------------------------------


def _stochastic(node: Node) -> tuple[Assignment, ...]:
    """Return the draws."""
    count, seed = node.integer("numberOfTestRuns"), node.text("randomSeed", "0")
    if not 0 < count <= MOST_RUNS:
        raise node.fault(f"the distribution has {count} runs; give 1 to {MOST_RUNS}")
    draws: dict[str, list[str]] = {}
    for one in node.children("StochasticDistribution"):
        name, inside = one.text("parameterName"), one.only()
        if inside.tag not in DRAWS:
            raise inside.fault(f"<{inside.tag}> is not supported; use one of {', '.join(DRAWS)}")
        rng = random.Random(f"{seed} {name}")  # noqa: S311 - draws that can be had again
        draw = DRAWS[inside.tag](inside, rng)
        draws[name] = [draw() for _ in range(count)]
    if not draws:
        raise node.fault("<Stochastic> has no distribution; add a <StochasticDistribution>")
    return tuple({name: values[nth] for name, values in draws.items()} for nth in range(count))


def _within(node: Node, draw: Callable[[], float]) -> Callable[[], str]:
    """Return draws inside the range that the distribution may have."""
    inside = node.find("Range")
    low, high = (-math.inf, math.inf) if inside is None else _limits(inside)

    def again() -> str:
        for _ in range(MOST_TRIES):
            value = draw()
            if low <= value <= high:
                return _text(value)
        raise node.fault(f"none of {MOST_TRIES} draws lies from {low:g} to {high:g}; correct the range")

    return again


def _moments(node: Node) -> tuple[float, float]:
    """Return expected value and variance."""
    mean, variance = node.number("expectedValue"), node.number("variance")
    if not variance >= 0.0 or math.isinf(variance) or math.isinf(mean):
        raise node.fault(f"an expected value of {mean:g} with a variance of {variance:g} is impossible; correct them")
    return mean, variance


def _normal(node: Node, rng: random.Random) -> Callable[[], str]:
    """Return draws from a normal distribution."""
    mean, variance = _moments(node)
    return _within(node, lambda: rng.gauss(mean, math.sqrt(variance)))


def _log_normal(node: Node, rng: random.Random) -> Callable[[], str]:
    """Return draws from a log-normal distribution; the file gives its own moments, not those of the logarithm."""
    mean, variance = _moments(node)
    if not mean > 0.0:
        raise node.fault(f"a log-normal distribution has no expected value of {mean:g}; give one above 0")
    spread = math.log1p(variance / (mean * mean))
    return _within(node, lambda: rng.lognormvariate(math.log(mean) - spread / 2.0, math.sqrt(spread)))


def _uniform(node: Node, rng: random.Random) -> Callable[[], str]:
    """Return draws from a uniform distribution."""
    low, high = _limits(node.child("Range"))
    return lambda: _text(rng.uniform(low, high))


def _poisson(node: Node, rng: random.Random) -> Callable[[], str]:
    """Return draws from a Poisson distribution: arrivals within its expected value (Knuth 1969, 3.4.1)."""
    mean = node.number("expectedValue")
    if not 0.0 <= mean < MOST_TRIES:
        raise node.fault(f"a Poisson distribution with {mean:g} is not supported; give 0 to {MOST_TRIES}")

    def draw() -> float:
        count, passed = 0, rng.expovariate(1.0)
        while passed < mean:
            count, passed = count + 1, passed + rng.expovariate(1.0)
        return float(count)

    return _within(node, draw)


def _weights(nodes: list[Node], holder: Node) -> list[float]:
    """Return the weights of some elements."""
    weights = [one.number("weight") for one in nodes]
    if not weights or min(weights) < 0.0 or not 0.0 < sum(weights) < math.inf:
        raise holder.fault(f"<{holder.tag}> has no weight above 0, or one below; correct its weights")
    return weights


def _set(node: Node, rng: random.Random) -> Callable[[], str]:
    """Return draws from values with weights."""
    nodes = list(node.children("Element"))
    weights, values = _weights(nodes, node), [one.text("value") for one in nodes]
    return lambda: rng.choices(values, weights)[0]


def _histogram(node: Node, rng: random.Random) -> Callable[[], str]:
    """Return draws from bins with weights, uniform inside each bin."""
    nodes = list(node.children("Bin"))
    weights, bins = _weights(nodes, node), [_limits(one.child("Range")) for one in nodes]
    return lambda: _text(rng.uniform(*rng.choices(bins, weights)[0]))


def _text(value: float) -> str:
    """Return a number as an attribute has it."""
    return repr(round(value, DIGITS) + 0.0).removesuffix(".0")


DRAWS: dict[str, Callable[[Node, random.Random], Callable[[], str]]] = {
    "ProbabilityDistributionSet": _set,
    "NormalDistribution": _normal,
    "LogNormalDistribution": _log_normal,
    "UniformDistribution": _uniform,
    "PoissonDistribution": _poisson,
    "Histogram": _histogram,
}
"""The draws of each stochastic distribution, by its element."""
