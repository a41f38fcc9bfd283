"""BASU: the benchmark that judges a shuttle's driver, as an ordinary client of any CARLA 0.9.16 server."""

from __future__ import annotations

import importlib

__version__ = "0.1.0"
__all__ = ["AutonomousAgent", "Scoring", "close_simulator", "load", "open_simulator", "run", "run_scenarios"]

_HOMES = {
    "AutonomousAgent": "basu.agents.autonomous_agent",
    "Scoring": "basu.metrics.scoring",
    "close_simulator": "basu.api",
    "load": "basu.api",
    "open_simulator": "basu.api",
    "run": "basu.api",
    "run_scenarios": "basu.api",
}


def __getattr__(name: str) -> object:
    """Import a public name when it is first used: the official client and the plots are not needed before."""
    if name not in _HOMES:
        raise AttributeError(f"module 'basu' has no attribute '{name}'")
    return getattr(importlib.import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
