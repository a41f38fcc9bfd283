"""`run_metric` runs a metric from a Python file and saves or shows its pictures; `BasicMetric` is its base class.

Files written for ScenarioRunner import its ``BasicMetric``. Where ScenarioRunner is not installed, ours stands in
under that name as long as the file runs.
"""

from __future__ import annotations

import contextlib
import importlib.util
import inspect
import os
import platform
import sys
import traceback
import warnings
from abc import ABC, abstractmethod
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import matplotlib as mpl

from basu.errors import UserError
from basu.files import module_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    import carla

    from basu_carla_log.metrics_log import MetricsLog


class BasicMetric(ABC):
    """A question to a recording; a file with one class of this kind is what ``basu metrics --metric`` takes."""

    def __init__(self, town_map: carla.Map, log: MetricsLog, criteria: Mapping[str, Any] | None = None) -> None:
        self._create_metric(town_map, log, criteria)

    @abstractmethod
    def _create_metric(self, town_map: carla.Map, log: MetricsLog, criteria: Mapping[str, Any] | None) -> None:
        """Ask the log, and print, draw or write what comes of it.

        Args:
            town_map: the map the run lay in.
            log: the recording.
            criteria: what the run was judged by, a dict a criterion; None without a judgement.
        """


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


def off_screen(plot: Path | None) -> None:
    """Draw without a window where pictures are to be kept, or where there is no screen to show them on."""
    if plot is not None and not plot.parent.is_dir():
        raise UserError(f"--plot {plot}: there is no folder {plot.parent}; make it, or name another place")
    if plot is not None or not _screen():
        mpl.use("Agg")
        warnings.filterwarnings("ignore", message=".*is non-interactive, and thus cannot be shown")


def drawn(plot: Path | None) -> list[str]:
    """Keep the figures that are open, and say what became of them, a line each.

    Raises:
        UserError: a picture cannot be written.
    """
    import matplotlib.pyplot as plt  # noqa: PLC0415 - after the backend is chosen

    numbers = plt.get_fignums()
    try:
        if plot is not None:
            return _kept(plot, numbers)
        if not numbers or _screen():
            return []
        several = f"{len(numbers)} figures" if len(numbers) > 1 else "a figure"
        return [f"drew {several}; --plot FILE.png keeps what is drawn"]
    finally:
        plt.close("all")


def _kept(plot: Path, numbers: list[int]) -> list[str]:
    """Write each figure to its file."""
    import matplotlib.pyplot as plt  # noqa: PLC0415 - after the backend is chosen

    if not numbers:
        raise UserError(f"the metric drew nothing, so there is no {plot}")
    lines = []
    for count, number in enumerate(numbers, start=1):
        path = plot if count == 1 else plot.with_stem(f"{plot.stem}-{count}")
        try:
            plt.figure(number).savefig(path, dpi=150)
        except (OSError, ValueError) as error:
            raise UserError(f"{path} could not be written: {error}") from error
        lines.append(f"plot              {path}")
    return lines


def _screen() -> bool:
    """Whether there is a screen that a window could be on."""
    if platform.system() == "Linux":
        return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    return True
