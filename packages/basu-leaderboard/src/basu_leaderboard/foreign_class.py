"""`foreign_agent`: finds a leaderboard or ScenarioRunner agent in a file, checks it, and says how to call it."""

from __future__ import annotations

import enum
import inspect
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Mapping


ENTRY_POINT = "get_entry_point"
BASES_OF_SCENARIO_RUNNER = frozenset(
    {"srunner.autoagents.autonomous_agent", "basu_leaderboard.provided.scenario_runner_agent"}
)
BASES_OF_LEADERBOARD = frozenset(
    {"leaderboard.autoagents.autonomous_agent", "basu_leaderboard.provided.leaderboard_agent"}
)
CALLS: dict[str, tuple[Any, ...]] = {
    "setup": ("",),
    "sensors": (),
    "run_step": ({}, 0.0),
    "set_global_plan": ([], []),
    "destroy": (),
}
"""The methods of an agent, with arguments of the kind they are called with."""


class Dialect(enum.Enum):
    """How an agent wants to be called."""

    LEADERBOARD_2 = "leaderboard 2.x"  # __init__(host, port, debug), set_global_plan, setup(path)
    LEADERBOARD_1 = "leaderboard 1.0"  # __init__(path), which calls setup; then set_global_plan
    SCENARIO_RUNNER = "ScenarioRunner"  # likewise


class ForeignAgent(NamedTuple):
    """An agent's class and how to call it."""

    agent_class: type[Any]
    dialect: Dialect


def foreign_agent(
    namespace: Mapping[str, object], module_name: str, path: str, class_name: str | None
) -> ForeignAgent | None:
    """The agent in an executed file, None where there is none of this kind; ``class_name`` picks one of several.

    The leaderboard asks ``get_entry_point``; ScenarioRunner has no such function and takes the file's name, where we
    take the only class there is.

    Raises:
        UserError: there is one, and it is not as an agent has to be.
    """
    entry_point = namespace.get(ENTRY_POINT)
    if class_name is None and entry_point is not None:
        found = _entered(namespace, entry_point, path)
    else:
        candidates = [
            value
            for value in namespace.values()
            if isinstance(value, type)
            and value.__module__ == module_name
            and _derives(value, BASES_OF_SCENARIO_RUNNER | BASES_OF_LEADERBOARD)
            and class_name in {None, value.__name__}
        ]
        if not candidates:
            return None
        if len(candidates) > 1:
            names = [value.__name__ for value in candidates]
            raise UserError(f"{path} holds {len(names)} agents ({', '.join(names)}); name one as {path}:{names[0]}")
        found = candidates[0]
    _check(found, path)
    return ForeignAgent(found, _dialect(found))


def _entered(namespace: Mapping[str, object], entry_point: object, path: str) -> type[Any]:
    """The class that ``get_entry_point`` names."""
    if not callable(entry_point):
        raise UserError(f"{path}: {ENTRY_POINT} is no function; it must return the name of the agent's class")
    try:
        name = entry_point()
    except (Exception, SystemExit) as error:
        raise UserError(f"{path}: {ENTRY_POINT}() raised {type(error).__name__}: {error}") from error
    if not isinstance(name, str):
        raise UserError(
            f"{path}: {ENTRY_POINT}() returned {type(name).__name__}; it must return the name of the agent's class"
        )
    found = namespace.get(name)
    if not isinstance(found, type):
        raise UserError(f"{path}: {ENTRY_POINT}() names '{name}', and the file has no class of that name")
    return found


def _check(agent_class: type[Any], path: str) -> None:
    """Whether all is there, and takes what it will be called with."""
    for name, arguments in CALLS.items():
        method = getattr(agent_class, name, None)
        if not callable(method):
            raise UserError(
                f"{agent_class.__name__} in {path} lacks {name}; an agent of the leaderboard has {', '.join(CALLS)}"
            )
        given = arguments if isinstance(inspect.getattr_static(agent_class, name), staticmethod) else (None, *arguments)
        try:
            signature = inspect.signature(method)
        except ValueError:
            continue  # compiled, and says nothing about itself
        try:
            signature.bind(*given)
        except TypeError as error:
            raise UserError(
                f"{name} of {agent_class.__name__} in {path} cannot be called as the leaderboard does: {error}"
            ) from error
    if (version := _ros_version(agent_class, path)) in (1, 2):
        raise UserError(
            f"{agent_class.__name__} in {path} is an agent for ROS {version}, which the leaderboard's own "
            f"bridge serves; start its software by itself and drive with basu run {'ros1' if version == 1 else 'ros'}"
        )


def _ros_version(agent_class: type[Any], path: str) -> object:
    """What an agent of the leaderboard 2.x says of ROS."""
    if not isinstance(inspect.getattr_static(agent_class, "get_ros_version", None), staticmethod):
        return None
    try:
        return agent_class.get_ros_version()
    except (Exception, SystemExit) as error:
        raise UserError(
            f"get_ros_version of {agent_class.__name__} in {path} raised {type(error).__name__}: {error}"
        ) from error


def _dialect(agent_class: type[Any]) -> Dialect:
    """How it wants to be called, by its base and by what it is made with."""
    if _derives(agent_class, BASES_OF_SCENARIO_RUNNER) and not _derives(agent_class, BASES_OF_LEADERBOARD):
        return Dialect.SCENARIO_RUNNER
    try:
        inspect.signature(agent_class).bind("host", 0, 0)
    except TypeError:
        return Dialect.LEADERBOARD_1
    except ValueError:  # compiled, and says nothing about itself
        return Dialect.LEADERBOARD_2
    return Dialect.LEADERBOARD_2


def _derives(agent_class: type[Any], modules: frozenset[str]) -> bool:
    return any(base.__module__ in modules for base in agent_class.__mro__)
