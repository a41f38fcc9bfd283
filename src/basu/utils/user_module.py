"""A Python file of a user's as a module: agents, metrics and scenarios are read so."""

from __future__ import annotations

import importlib.util
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from importlib.abc import Loader
    from pathlib import Path
    from types import ModuleType


def module_of(path: Path, name: str) -> tuple[ModuleType, Loader]:
    """The module of a file, known by ``name`` and not yet executed, and what executes it; ``path`` ends in .py.

    Its folder is searched after everything else: a file of several finds its own, and shadows nothing.
    """
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None, "a path that ends in .py has a loader"
    assert spec.loader is not None, "likewise"
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    beside = str(path.resolve().parent)
    if beside not in sys.path:
        sys.path.append(beside)
    return module, spec.loader
