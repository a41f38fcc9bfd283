"""The Dockerfile fits the project: its files and commands exist, and it runs as a user without rights."""

import re
import sys
from pathlib import Path

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).parents[1]
LINES = (ROOT / "Dockerfile").read_text(encoding="utf-8").replace("\\\n", " ").splitlines()
PROJECTS = {
    name: tomllib.loads((ROOT / "packages" / name / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    for name in ("linden", "basu")
}


def instructions(name: str) -> list[str]:
    """Return what follows an instruction, at each place where it stands."""
    return [line.removeprefix(name).strip() for line in LINES if line.startswith(name + " ")]


def test_every_copied_file_exists_and_is_sent_to_the_daemon() -> None:
    sent = (ROOT / ".dockerignore").read_text(encoding="utf-8").splitlines()
    copied = [name for line in instructions("COPY") for name in line.split()[:-1]]
    assert {"packages", "LICENSE"} <= set(copied), "the distributions' licences are links to the project's"
    for name in copied:
        assert (ROOT / name).exists(), name
        assert f"!{name}" in sent


def test_every_command_is_one_of_the_projects() -> None:
    from linden.cli import parser  # noqa: PLC0415 - what the image runs

    (command,) = instructions("CMD")
    words = re.findall(r'"([^"]*)"', command)
    assert words[0] in PROJECTS["linden"]["scripts"]
    arguments = parser().parse_args(words[1:])
    assert (arguments.host, arguments.port) == ("0.0.0.0", 2000)
    assert "linden compile" in instructions("RUN")
    assert callable(parser().parse_args(["compile"]).command)


def test_it_installs_the_server_and_the_benchmark() -> None:
    (install,) = [line for line in instructions("RUN") if line.startswith("pip install")]
    assert {f"./packages/{name}" for name in PROJECTS} <= set(install.split())


def test_it_runs_as_a_user_without_rights_on_the_ports_of_carla() -> None:
    assert instructions("USER") == ["linden"]
    assert instructions("EXPOSE") == ["2000 2001 2002"]
    places = {line.split()[0]: number for number, line in enumerate(LINES) if line.strip()}
    assert places["USER"] < places["CMD"]


def test_its_python_is_one_that_the_project_supports() -> None:
    (image,) = instructions("FROM")
    version = tuple(map(int, re.findall(r"\d+", image)[:2]))
    lowest, highest = (
        tuple(map(int, re.findall(r"\d+", bound))) for bound in PROJECTS["linden"]["requires-python"].split(",")
    )
    assert lowest <= version < highest
