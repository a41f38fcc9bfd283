"""Files and modules that README, docs and the changelog name exist."""

import importlib
import re
import subprocess
from functools import cache
from pathlib import Path

import pytest

import linden.cli.compiling
from basu import plugins
from docs.pages import INLINE, PAGES, ROOT, without_fences

TEXTS = [*PAGES, ROOT / "CHANGELOG.md"]
FROM_ROOT = re.compile(r"(?<![\w/.…])((?:src|packages|tests|scripts|examples|benchmarks|docs)/[\w./*-]*[\w*])")
PACKAGES = "|".join(path.parent.name for path in ROOT.glob("packages/*/src/*/__init__.py"))
MODULE = re.compile(rf"(?<![\w./-])((?:{PACKAGES})(?:\.\w+)+)(?!\.?[\w/])")
PART = re.compile(r"^(?:\w+/)+\w+\.(?:py|json|geojson|xodr|md)$")
OTHERS = "outside-programs.md"  # names files of other programs
GROUPS = {*plugins.DISTRIBUTIONS, plugins.SCENARIO_FILES, linden.cli.PLUGINS, linden.cli.compiling.PLUGINS}
"""Of entry points; no modules."""
FILES = (".osm", ".pcd", ".xml", ".xodr")  # ends of names of files, not of modules


@cache
def tracked() -> frozenset[str]:
    """All files of the repository, and their folders."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.splitlines()
    found = {path for path in listed if (ROOT / path).exists()}
    return frozenset(found | {str(parent) for path in found for parent in Path(path).parents})


def exists(name: str) -> bool:
    """Whether a path from the root, perhaps with ``*``, is there."""
    return any(ROOT.glob(name)) if "*" in name else name.rstrip("/") in tracked()


def ids(page: Path) -> str:
    return str(page.relative_to(ROOT))


@pytest.mark.parametrize("page", TEXTS, ids=ids)
def test_each_path_from_the_root_exists(page: Path) -> None:
    named = set(FROM_ROOT.findall(re.sub(r"https?://\S+", "", page.read_text("utf-8"))))
    if page.name == OTHERS:
        named = {name for name in named if not name.startswith("examples/")}
    assert not sorted(name for name in named if not exists(name))


@pytest.mark.parametrize("page", TEXTS, ids=ids)
def test_each_part_of_a_path_in_code_is_the_end_of_one(page: Path) -> None:
    named = {code for code in INLINE.findall(without_fences(page.read_text("utf-8"))) if PART.match(code)}
    if page.name == OTHERS:
        named = {name for name in named if name.startswith("server/")}
    assert not sorted(name for name in named if not any(f"/{path}".endswith(f"/{name}") for path in tracked()))


@pytest.mark.parametrize("page", TEXTS, ids=ids)
def test_each_module_or_member_exists(page: Path) -> None:
    text = re.sub(r"https?://\S+", "", page.read_text("utf-8"))
    typed = re.findall(r"^ *(?:from|import) \S+|python -m \S+", text, re.MULTILINE)
    code = " ".join([*INLINE.findall(without_fences(text)), *typed])
    named = {name for name in MODULE.findall(code) if not name.endswith(FILES) and name not in GROUPS}
    assert not sorted(name for name in named if not member_exists(name))


def member_exists(name: str) -> bool:
    """Whether a dotted name is a module, or a member of one."""
    parts = name.split(".")
    for length in range(len(parts), 0, -1):
        try:
            found = importlib.import_module(".".join(parts[:length]))
        except ModuleNotFoundError:
            continue
        for attribute in parts[length:]:
            if attribute in getattr(found, "__annotations__", {}):
                return True
            if not hasattr(found, attribute):
                return False
            found = getattr(found, attribute)
        return True
    return False


def test_what_does_not_exist_is_found() -> None:
    assert not exists("packages/basu/src/basu/no_such_module.py")
    assert exists("packages/basu/src/basu/agents")
    assert not member_exists("basu.no_such_module")
    assert member_exists("basu.agents.sight.Sight")
