"""Names of modules, classes and functions that docstrings, comments and documents of the project give exist."""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

import linden.cli.compiling
from basu import plugins

ROOT = Path(__file__).parents[2]
SOURCES = sorted((ROOT / "packages").glob("*/src"))
PACKAGES = "|".join(path.name for source in SOURCES for path in source.iterdir() if path.is_dir())
NAME = re.compile(rf"`{{1,2}}~?((?:{PACKAGES})(?:\.[A-Za-z_]\w*)+)(?:\(\))?`")


GROUPS = {*plugins.DISTRIBUTIONS, plugins.SCENARIO_FILES, linden.cli.PLUGINS, linden.cli.compiling.PLUGINS}
"""Of entry points; no modules."""


def test_dotted_names_in_the_source_and_the_documents_exist() -> None:
    code = [path for source in SOURCES for path in source.rglob("*.py")]
    texts = [*code, *(ROOT / "docs").rglob("*.md"), ROOT / "README.md"]
    dead = {
        f"{path.relative_to(ROOT)}: {name}"
        for path in texts
        if "decisions" not in path.parts
        for name in NAME.findall(path.read_text())
        if name not in GROUPS and not exists(name)
    }
    assert not dead


def exists(name: str) -> bool:
    """Whether a dotted name is a module or package, or something that one of them defines or imports."""
    parts = name.split(".")
    source = next((source for source in SOURCES if (source / parts[0]).is_dir()), ROOT)
    for length in range(len(parts), 0, -1):
        path = source.joinpath(*parts[:length])
        file = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
        if file.is_file():
            return defines(file, tuple(parts[length:]))
        if path.is_dir():
            return length == len(parts)
    return False


def defines(file: Path, parts: tuple[str, ...]) -> bool:
    return not parts or (parts[0] in names(file) and (len(parts) == 1 or ".".join(parts[:2]) in names(file)))


@cache
def names(file: Path) -> frozenset[str]:
    """Top-level names of a module, and those of the bodies of its classes with the class's name before."""
    return frozenset(found(ast.parse(file.read_text()).body, ""))


def found(body: list[ast.stmt], prefix: str) -> set[str]:
    out: set[str] = set()
    for node in body:
        match node:
            case ast.FunctionDef() | ast.AsyncFunctionDef():
                out.add(prefix + node.name)
            case ast.ClassDef():
                out |= {prefix + node.name, *found(node.body, f"{prefix}{node.name}.")}
            case ast.Import() | ast.ImportFrom():
                out |= {prefix + (alias.asname or alias.name) for alias in node.names}
            case ast.Assign() | ast.AnnAssign():
                targets = node.targets if isinstance(node, ast.Assign) else [node.target]
                named = {name.id for target in targets for name in ast.walk(target) if isinstance(name, ast.Name)}
                out |= {prefix + name for name in named}
                if "__all__" in named and node.value is not None:
                    out |= set(ast.literal_eval(node.value))
            case ast.If() | ast.Try() | ast.With():
                out |= found(node.body, prefix) | found(getattr(node, "orelse", []), prefix)
    return out
