"""The commands of the tutorials work as written, with ``basu`` and the distributions that a page asks for.

The environment has the packages that the metadata of ``basu`` requires, and no other: a package of a plugin or of an
extra that is imported by mistake is missing in it, as it is for a newcomer.
"""

import os
import re
import subprocess
import venv
from collections.abc import Iterable, Iterator
from importlib import metadata
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from docs.pages import ROOT, command_in, shell_lines

TUTORIALS = ROOT / "docs" / "tutorials"
INSTALLED = re.compile(r"pip install '?([\w-]+(?:\[[\w,]+\])?)'?$")
SAVED = re.compile(r"<!-- file (\S+) -->")
ELSEWHERE = {
    "basu run basic --routes routes/linden_short.xml": "packages/basu/tests/running drives it",
    "basu run basic --routes routes/linden_short.xml --vehicles 30 --walkers 20 --seed 7": "takes 20 s",
    "basu run forward --routes routes/linden_short.xml": "test_baselines.py drives it",
    "basu compare runs/ONE runs/ANOTHER": "the reader's runs; packages/basu/tests/output/report/test_comparison.py",
    "basu run my_agent.py": "takes 20 s; test_examples.py loads the agent",
    "basu run stopping_agent.py": "takes 20 s; test_examples.py loads the agent",
    "basu run my_agent.py --vehicles 50 --walkers 30 --seed 7": "takes 60 s",
    "basu scenario run roundabout --agent my_agent.py": "takes a minute",
    "basu scenario run bin_lorry.xml --agent basic --agent forward": "takes 20 s",
    "basu scenario run bin_lorry.xml --agent basic --sweep 50 --seed 1 --vary ahead,stands": "takes minutes",
    "linden serve": "does not end; packages/linden/tests/cli/test_serve.py",
    "basu run my_agent.py --routes routes/linden_short.xml --seed 1": "takes 20 s",
    "basu run my_agent.py --routes routes/linden_short.xml --seed 1 --require driving=0.99": "takes 20 s",
    "basu scenario run all --agent my_agent.py --junit junit.xml": "takes minutes",
    "basu scenario run pedestrian --agent my_agent.py --junit junit.xml": "takes a minute",
    "basu scenario run all --where lighting=dark --agent my_agent.py --junit junit.xml": "takes minutes",
    "basu run --config runs/latest": "repeats a run of the reader",
}
"""Commands that are not run here, with the reason; a new command of a tutorial is run."""


def distributions(wanted: Iterable[str]) -> Iterator[metadata.Distribution]:
    """Yield the distributions that requirements such as ``basu[gym]`` lead to, each once for each set of extras."""
    todo, seen = [Requirement(each) for each in wanted], set()
    while todo:
        requirement = todo.pop()
        key = requirement.name, tuple(sorted(requirement.extras))
        if key in seen:
            continue
        seen.add(key)
        found = metadata.distribution(requirement.name)
        yield found
        extras = "", *requirement.extras
        todo += [
            needed
            for needed in map(Requirement, found.requires or ())
            if needed.marker is None or any(needed.marker.evaluate({"extra": extra}) for extra in extras)
        ]


class Environment:
    """A Python with chosen packages of the one that runs the tests, linked and not copied."""

    def __init__(self, folder: Path) -> None:
        venv.create(folder, symlinks=True)
        self.bin = folder / "bin"
        (self.site,) = folder.glob("lib/python*/site-packages")
        for name in ("basu", "linden"):
            program = self.bin / name
            program.write_text(f"#!{self.bin / 'python'}\nimport sys\nfrom {name}.cli import main\nsys.exit(main())\n")
            program.chmod(0o755)

    def install(self, requirement: str) -> None:
        """Link all that a requirement leads to; the distributions of this project are found where their sources are."""
        for each in distributions([requirement]):
            sources = ROOT / "packages" / each.name / "src"
            if sources.is_dir():
                (self.site / f"{each.name}.pth").write_text(f"{sources}\n", "utf-8")
            for file in each.files or ():
                top = file.parts[0]
                if top in {"..", "__pycache__"} or top.endswith(".pth") or (self.site / top).exists():
                    continue
                (self.site / top).symlink_to(each.locate_file(top))

    def run(self, *words: str, folder: Path) -> "subprocess.CompletedProcess[str]":
        variables = {**os.environ, "PATH": f"{self.bin}:{os.environ['PATH']}"}
        variables.pop("PYTHONPATH", None)
        return subprocess.run(
            words, cwd=folder, env=variables, capture_output=True, text=True, timeout=200, check=False
        )


@pytest.fixture
def base(tmp_path: Path) -> Environment:
    made = Environment(tmp_path / "environment")
    made.install("basu")
    return made


def saved_files(text: str, folder: Path) -> None:
    """Save the files that a page shows in full, under the names that it uses."""
    for name in SAVED.findall(text):
        (folder / Path(name).name).write_bytes((ROOT / name).read_bytes())


def steps(text: str) -> list[str]:
    """Return the lines of a page that install a distribution or are a command of ours, in their order."""
    return [line.strip() for line in shell_lines(text) if INSTALLED.search(line) or command_in(line)]


@pytest.mark.slow
@pytest.mark.parametrize("page", sorted(path.name for path in TUTORIALS.glob("*.md")))
def test_the_commands_of_a_tutorial_work_in_a_base_installation(page: str, base: Environment, tmp_path: Path) -> None:
    text = (TUTORIALS / page).read_text("utf-8")
    desk = tmp_path / "desk"
    (desk / "towns").mkdir(parents=True)
    for name in ("examples", "routes"):
        (desk / name).symlink_to(ROOT / name)
    saved_files(text, desk)
    for step in steps(text):
        if wanted := INSTALLED.search(step):
            base.install(wanted[1])
        elif (words := command_in(step)) and " ".join(words) not in ELSEWHERE:
            done = base.run(*words, folder=desk)
            assert done.returncode == 0, f"{step}\n{done.stdout}\n{done.stderr}"


def test_packages_of_plugins_and_extras_are_missing_in_the_base_installation(base: Environment, tmp_path: Path) -> None:
    others = "pyproj", "pandas", "gymnasium", "rosbags", "libsumo", "sklearn", "linden_maps", "basu_sumo"
    ask = f"import importlib.util as u, basu, linden; print([n for n in {others} if u.find_spec(n)])"
    done = base.run(str(base.bin / "python"), "-c", ask, folder=tmp_path)
    assert done.stdout == "[]\n", done.stderr
    base.install("linden-maps")
    assert base.run(str(base.bin / "python"), "-c", "import pyproj", folder=tmp_path).returncode == 0


def test_a_step_without_its_distribution_is_noticed(base: Environment, tmp_path: Path) -> None:
    village = ROOT / "examples" / "maps" / "village.geojson"
    done = base.run("linden", "map", "build", str(village), "-o", "Village.xodr", folder=tmp_path)
    assert done.returncode == 2
    assert "pip install linden-maps" in done.stderr


def test_commands_that_are_not_run_stand_in_a_tutorial() -> None:
    shown = {" ".join(command_in(step)) for path in TUTORIALS.glob("*.md") for step in steps(path.read_text("utf-8"))}
    assert set(ELSEWHERE) <= shown
