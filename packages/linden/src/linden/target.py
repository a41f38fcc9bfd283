"""The processor that kernels are compiled for: a level of x86-64, so that code from one machine runs on another.

numba would compile for the very processor of this machine. Two machines of one level can load the same machine code
(docs/decisions/0062-first-start.md). Levels: the x86-64 psABI, "Micro-Architecture Levels".
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import llvmlite.binding
import numba


class Level(NamedTuple):
    """A level of x86-64, as LLVM names it."""

    name: str
    options: str
    """LLVM's options beside those of the level."""
    needs: frozenset[str]
    """Features of a processor, by LLVM's names."""


_V3 = frozenset({"avx", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe"})
LEVELS = (
    # eight floats of 64 bits at a time, which pictures are made with; by itself LLVM takes four at this level
    Level("x86-64-v4", "-prefer-256-bit", _V3 | {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"}),
    Level("x86-64-v3", "", _V3),
)
"""Highest first."""


def levels_of(features: Mapping[str, bool]) -> list[Level]:
    """Return the levels that a processor with these features has, highest first."""
    return [level for level in LEVELS if all(map(features.get, level.needs))]


def choose() -> str:
    """Set the target of numba's compiler, and return its name; "host" is this very processor.

    ``NUMBA_CPU_NAME`` and ``NUMBA_CPU_FEATURES`` in the environment have precedence. A process that has compiled
    functions of its own keeps their target.
    """
    config: Any = numba.config
    if config.CPU_NAME is None:
        levels = levels_of(llvmlite.binding.get_host_cpu_features())
        if not levels:
            return "host"
        config.CPU_NAME, config.CPU_FEATURES, _ = levels[0]
    return str(config.CPU_NAME)
