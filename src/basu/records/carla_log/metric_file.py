"""A user's metric: its class found in a Python file, and run; what goes wrong in it is told with its line.

Files written for ScenarioRunner import its ``BasicMetric``. Where ScenarioRunner is not installed, ours stands in
under that name as long as the file runs.
"""

from __future__ import annotations

import contextlib
import importlib.util
import inspect
import sys
import traceback
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.records.carla_log.basic_metric import BasicMetric
from basu.utils.user_module import module_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from basu.records.carla_log.metrics_log import MetricsLog

BASE = BasicMetric.__name__
_THEIRS = "srunner.metrics.examples.basic_metric"


def run_metric(wanted: str, town_map: Any, log: MetricsLog, criteria: Mapping[str, Any] | None) -> str:  # noqa: ANN401
    """Run ``file.py``, or ``file.py:Class`` where it has several; ``town_map`` is a ``carla.Map`` or stands for one.

    Returns:
        The name of the class.

    Raises:
        UserError: there is no such file or class, or it failed; what it failed with is the error's cause.
    """
    text, _, class_name = wanted.partition(":") if ".py:" in wanted else (wanted, "", "")
    path = Path(text)
    if path.suffix != ".py" or not path.is_file():
        raise UserError(f"the metric {path} is not there; name a Python file, as in --metric my_metric.py")
    with _scenario_runner():
        module = _executed(path)
        chosen = _chosen(module, path, class_name)
        try:
            chosen(town_map, log, criteria)
        except UserError:
            raise
        except (Exception, SystemExit) as error:
            raise UserError(f"the metric {chosen.__name__} raised {_told(error, path)}") from error
    return chosen.__name__


def _executed(path: Path) -> ModuleType:
    """The file as a module."""
    module, loader = module_of(path.resolve(), f"basu_metric_{path.stem}")
    try:
        loader.exec_module(module)
    except SyntaxError as error:
        raise UserError(f"the metric {path} is no Python: line {error.lineno}: {error.msg}") from error
    except (Exception, SystemExit) as error:
        raise UserError(f"the metric {path} does not load: {_told(error, path)}") from error
    return module


def _chosen(module: ModuleType, path: Path, class_name: str) -> type[Any]:
    """The class that is meant."""
    found = {
        name: value
        for name, value in vars(module).items()
        if isinstance(value, type)
        and value.__module__ == module.__name__
        and any(base.__name__ == BASE for base in value.__mro__[1:])
    }
    if not found:
        raise UserError(f"{path} has no class that is a {BASE}; a metric is a `class Mine({BASE})` with _create_metric")
    if class_name and class_name not in found:
        raise UserError(f"{path} has no metric {class_name}; it has {', '.join(found)}")
    if not class_name and len(found) > 1:
        raise UserError(f"{path} has {len(found)} metrics ({', '.join(found)}); name one as {path}:{next(iter(found))}")
    chosen = found[class_name or next(iter(found))]
    if inspect.isabstract(chosen):
        raise UserError(f"the metric {chosen.__name__} in {path} has no _create_metric(self, town_map, log, criteria)")
    return chosen


def _told(error: BaseException, path: Path) -> str:
    """An exception in words, with the last line of the user's own file that it went through."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if frame.filename == str(path.resolve())]
    where = f" (line {own[-1].lineno} of {path})" if own else ""
    return f"{type(error).__name__}: {error}{where}"


@contextlib.contextmanager
def _scenario_runner() -> Iterator[None]:
    """Have ScenarioRunner's name for ``BasicMetric`` importable, by our own where there is no other."""
    if "srunner" in sys.modules or importlib.util.find_spec("srunner") is not None:
        yield
        return
    parts = _THEIRS.split(".")
    names = [".".join(parts[: end + 1]) for end in range(len(parts))]
    for name in names:
        module = ModuleType(name)
        module.__path__ = []  # a package, so that what lies in it may be imported by its whole name
        sys.modules[name] = module
    sys.modules[_THEIRS].__dict__[BASE] = BasicMetric
    try:
        yield
    finally:
        for name in names:
            del sys.modules[name]
