"""Calls of a scenario's code: what goes wrong in them is the scenario's, and is told with file and line."""

from __future__ import annotations

import traceback
from typing import TYPE_CHECKING

from basu.errors import BasuError, ScenarioError, SimulatorError

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import TypeVar

    T = TypeVar("T")


def asked(who: str, call: Callable[[], T]) -> T:
    """One call of a scenario's code; what goes wrong in it is the scenario's.

    Raises:
        ScenarioError: it raised.
        SimulatorError: the simulator did not answer it.
    """
    try:
        return call()
    except BasuError:
        raise
    except RuntimeError as error:
        if "time-out" in str(error):
            raise SimulatorError(f"the simulator failed in the scenario {who}: {error}") from error
        raise _scenarios(who, error) from error
    except Exception as error:
        raise _scenarios(who, error) from error


def _scenarios(who: str, error: Exception) -> ScenarioError:
    """What went wrong in a scenario's code, with its place."""
    where = traceback.extract_tb(error.__traceback__)[-1]
    return ScenarioError(
        f"the scenario {who} raised {type(error).__name__}: {error} (line {where.lineno} of {where.filename})"
    )
