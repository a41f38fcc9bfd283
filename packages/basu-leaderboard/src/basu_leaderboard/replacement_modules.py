"""Replaces ``leaderboard``, ``srunner`` and ``agents`` where they are not installed.

A finder at the end of ``sys.meta_path``: Python asks it only for what it found nowhere else, so an installed package
always goes before ours. A part that we do not have is refused with the name of the folder that has it.
"""

from __future__ import annotations

import importlib
import importlib.abc
import importlib.machinery
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import ModuleType


HOME = "basu_leaderboard.provided"
PROVIDED = {
    "leaderboard.autoagents.autonomous_agent": f"{HOME}.leaderboard_agent",
    "leaderboard.utils.route_manipulation": f"{HOME}.planned_agent",
    "srunner.autoagents.autonomous_agent": f"{HOME}.scenario_runner_agent",
    "srunner.scenariomanager.carla_data_provider": f"{HOME}.carla_data_provider",
    "srunner.scenariomanager.timer": f"{HOME}.carla_data_provider",
    "srunner.tools.route_manipulation": f"{HOME}.planned_agent",
    "agents.navigation.local_planner": f"{HOME}.planned_agent",
}
"""Under which name an agent imports which module of ours."""
PACKAGES = frozenset(name.rsplit(".", up)[0] for name in PROVIDED for up in (1, 2))
WHERE = {
    "leaderboard": "the CARLA leaderboard; put its folder (the one that holds `leaderboard`), ScenarioRunner's and "
    "CARLA's PythonAPI/carla on PYTHONPATH",
    "srunner": "ScenarioRunner; put its folder (the one that holds `srunner`) and CARLA's PythonAPI/carla on "
    "PYTHONPATH",
    "agents": "CARLA's PythonAPI; put the folder PythonAPI/carla of CARLA 0.9.16 on PYTHONPATH",
}


class _Finder(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Finds and makes the modules above."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        """The module of that name, where it is ours to give.

        Raises:
            ModuleNotFoundError: it is part of a package that we stand in for, but not of what we have of it.
        """
        del path, target
        parent, _, _ = fullname.rpartition(".")
        if fullname.partition(".")[0] not in WHERE or (parent and not is_ours(parent)):
            return None
        if fullname not in PROVIDED and fullname not in PACKAGES:
            raise ModuleNotFoundError(
                f"'{fullname}' is part of {WHERE[fullname.partition('.')[0]]}; what BASU itself brings of it is "
                + ", ".join(sorted(name for name in PROVIDED if name.startswith(fullname.partition(".")[0]))),
                name=fullname,
            )
        return importlib.machinery.ModuleSpec(fullname, self, is_package=fullname in PACKAGES)

    def exec_module(self, module: ModuleType) -> None:
        """Fill a module with what ours has; a package stays empty."""
        if module.__name__ in PROVIDED:
            ours = importlib.import_module(PROVIDED[module.__name__])
            module.__dict__.update({name: value for name, value in vars(ours).items() if not name.startswith("_")})
            module.__doc__ = ours.__doc__


_FINDER = _Finder()


def install() -> None:
    """Make imports find our modules where there are no others. A second call changes nothing."""
    if _FINDER not in sys.meta_path:
        sys.meta_path.append(_FINDER)


def uninstall() -> None:
    """Undo `install` and remove our modules from `sys.modules`, as tests do."""
    if _FINDER in sys.meta_path:
        sys.meta_path.remove(_FINDER)
    for name in [name for name in sys.modules if name.partition(".")[0] in WHERE and is_ours(name)]:
        del sys.modules[name]


def is_ours(name: str) -> bool:
    """Whether the module of that name, which is imported, is one of ours."""
    module = sys.modules.get(name)
    return module is not None and getattr(module.__spec__, "loader", None) is _FINDER
