"""The wheels of linden and basu outside of the checkout: both commands drive a route, without plugins.

The wheels are installed into an environment of their own. A .pth file lets it find the packages that they need among
those of the tests; optional ones and plugins are hidden. The server's wheel brings the kernels that the checkout has
compiled.
"""

import json
import os
import signal
import site
import subprocess
import sys
import venv
from pathlib import Path

import pytest
from alone import USES, piece_of_route
from build_wheel import PIP, plain_wheel, with_kernels

from linden.compiled import COMPILER_IS_OFF, TARGET

ROOT = Path(__file__).parents[1]
PLUGINS = tuple(name.replace("-", "_") for name in USES if name not in ("linden", "basu"))
OTHERS = ("gymnasium", "pyproj", "IPython", "nbclient", "warp", "carla_driver_interface", "grpc", "websockets")
OPTIONAL = (*OTHERS, *PLUGINS)


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the environment that has the wheels."""
    folder = tmp_path_factory.mktemp("wheel")
    sources = ROOT / "packages" / "linden" / "src"
    wheel = with_kernels(plain_wheel(folder), sources, sys.executable, [TARGET], folder / "dist")
    environment = folder / "environment"
    venv.create(environment, with_pip=False)
    python = environment / "bin" / "python"
    install = [*PIP, "--python", str(python), "install", "--no-deps", "--no-compile"]  # imports compile what they need
    subprocess.run([sys.executable, *install, str(wheel), str(plain_wheel(folder, "basu"))], check=True)
    packages = next(environment.glob("lib/python*/site-packages"))
    hiding = f"import sys; sys.modules.update(dict.fromkeys({OPTIONAL!r}))"
    (packages / "others.pth").write_text("\n".join([*site.getsitepackages(), hiding]) + "\n", encoding="utf-8")
    return environment


def run(environment: Path, folder: Path, *command: str) -> "subprocess.CompletedProcess[str]":
    """Run a command of the environment in a folder, without a word of the checkout; what maps give is kept already."""
    cache = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    names = {"PATH": os.defpath, "HOME": str(folder), "XDG_CACHE_HOME": cache}
    program, *options = command
    return subprocess.run(
        [str(environment / "bin" / program), *options],
        cwd=folder,
        env=names,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_basu_run_drives_with_the_simulator_of_the_wheel(installed: Path, tmp_path: Path) -> None:
    (tmp_path / "piece.xml").write_text(piece_of_route(), encoding="utf-8")
    done = run(
        installed, tmp_path, "basu", "run", "basic", "--routes", "piece.xml", "--no-scenarios", "--stop-after", "3"
    )
    assert done.returncode == 0, done.stdout + done.stderr
    result = json.loads((tmp_path / "runs" / "latest" / "result.json").read_text(encoding="utf-8"))
    assert result["scores"]["path_following"] > 0.0
    assert (tmp_path / "runs" / "latest" / "report.html").stat().st_size > 10_000


@pytest.mark.slow
def test_both_packages_are_those_of_the_wheel(installed: Path, tmp_path: Path) -> None:
    program = (
        "import basu, linden, pathlib; print(*(pathlib.Path(each.__file__).parents[1] for each in (basu, linden)))"
    )
    places = run(installed, tmp_path, "python", "-c", program).stdout.split()
    assert places
    assert all(Path(place).is_relative_to(installed) for place in places)


@pytest.mark.slow
@pytest.mark.parametrize("command", [["linden", "--version"], ["linden", "serve", "--help"], ["basu", "list"]])
def test_commands_need_no_optional_package(installed: Path, tmp_path: Path, command: list[str]) -> None:
    done = run(installed, tmp_path, *command)
    assert done.returncode == 0, done.stderr
    assert done.stdout


@pytest.mark.slow
@pytest.mark.skipif(COMPILER_IS_OFF, reason="nothing is compiled")
def test_a_first_start_with_an_empty_home_compiles_nothing(installed: Path, tmp_path: Path) -> None:
    def kernels() -> set[Path]:
        return {*installed.rglob("*.nb[ci]"), *tmp_path.rglob("*.nb[ci]")}

    before = kernels()
    assert before
    serve = [str(installed / "bin" / "linden"), "serve", "--sync", "--port", "0"]
    names = {"PATH": os.defpath, "HOME": str(tmp_path)}
    with subprocess.Popen(serve, cwd=tmp_path, env=names, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        said = server.stdout.readline()
        server.send_signal(signal.SIGINT)
    assert said.startswith("linden: ready")
    assert server.returncode == 0
    assert kernels() == before
