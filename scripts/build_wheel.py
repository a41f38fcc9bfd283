"""Build a wheel of linden that brings compiled kernels, so that a first start compiles nothing.

    .venv/bin/python scripts/build_wheel.py [--python python3.12] [--output dist]

It installs the wheel into an empty environment of the Python given, with the packages of constraints.txt. There it
compiles all kernels, once for each level of x86-64 that this machine has (linden/target.py). It packs them beside their
sources. The wheel is for that minor version of Python alone, as numba's files are (docs/decisions/0062-first-start.md).
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
SOURCES = ("src", "pyproject.toml", "README.md", "LICENSE")  # of a distribution
PIP = ("-m", "pip", "--quiet", "--disable-pip-version-check")
LEVELS = """
import json, llvmlite.binding
from linden.target import levels_of
print(json.dumps([(level.name, level.options) for level in levels_of(llvmlite.binding.get_host_cpu_features())]))
"""
KERNELS = """
import json, sys
from linden.sensors.compiling import versions
print(json.dumps({"versions": versions(), "targets": sys.argv[1:]}))
"""


def plain_wheel(folder: Path, distribution: str = "linden") -> Path:
    """Build a distribution's wheel without kernels in a folder, from a copy of its sources alone."""
    copy, sources = folder / f"sources-{distribution}", ROOT / "packages" / distribution
    copy.mkdir()
    for name in SOURCES:
        if (sources / name).is_dir():
            shutil.copytree(sources / name, copy / name, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"))
        else:
            shutil.copy(sources / name, copy)
    _run(sys.executable, *PIP, "wheel", str(copy), "--no-deps", "--wheel-dir", str(folder))
    (wheel,) = folder.glob(f"{distribution.replace('-', '_')}-*.whl")
    return wheel


def compiled(wheel: Path, python: str, folder: Path) -> tuple[Path, list[str]]:
    """Install a wheel into an environment of ``python``, and compile its kernels for each level of this machine.

    Returns the folder of the installed packages and the names of the levels.
    """
    environment = folder / "environment"
    _run(python, "-m", "venv", str(environment))
    own = str(environment / "bin" / "python")
    _run(own, *PIP, "install", "--constraint", str(ROOT / "constraints.txt"), str(wheel))
    levels: list[tuple[str, str]] = json.loads(_run(own, "-c", LEVELS))
    for name, options in levels:
        kept = folder / f"kept-{name}"  # maps; each level derives its own
        settings = {"NUMBA_CPU_NAME": name, "NUMBA_CPU_FEATURES": options, "XDG_CACHE_HOME": str(kept)}
        _run(own, "-m", "linden.cli", "compile", **settings)
    (packages,) = environment.glob("lib/python*/site-packages")
    return packages, [name for name, _ in levels]


def with_kernels(wheel: Path, packages: Path, python: str, targets: list[str], output: Path) -> Path:
    """Return the wheel in ``output`` that has the compiled kernels of ``packages`` beside its sources."""
    with tempfile.TemporaryDirectory() as folder:
        _run(sys.executable, "-m", "wheel", "unpack", str(wheel), "--dest", folder)
        (tree,) = Path(folder).iterdir()
        for file in (packages / "linden").rglob("*.nb[ci]"):
            target = tree / file.relative_to(packages)
            if target.parents[1].is_dir():  # else a module that has moved left it
                target.parent.mkdir(exist_ok=True)
                shutil.copy(file, target)
        (tree / "linden" / "kernels.json").write_text(_run(python, "-c", KERNELS, *targets), encoding="utf-8")
        output.mkdir(parents=True, exist_ok=True)
        _run(sys.executable, "-m", "wheel", "pack", str(tree), "--dest-dir", folder)
        minor = _run(python, "-c", "import sys; print('cp{}{}'.format(*sys.version_info))").strip()
        (packed,) = Path(folder).glob("*.whl")
        tags = ("--python-tag", minor, "--platform-tag", "linux_x86_64", "--remove")
        _run(sys.executable, "-m", "wheel", "tags", *tags, str(packed))
        (tagged,) = Path(folder).glob("*.whl")
        return Path(shutil.copy(tagged, output))


def _run(*command: str, **settings: str) -> str:
    """Run a command with settings in its environment, and return what it printed."""
    outside = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV")}
    done = subprocess.run(command, env={**outside, **settings}, stdout=subprocess.PIPE, text=True, check=True, cwd="/")
    return done.stdout


def main() -> None:
    """Build the wheel, and print its place and size."""
    parser = argparse.ArgumentParser(description="Build a wheel that brings compiled kernels.")
    parser.add_argument(
        "--python", default=sys.executable, help="Python to build for, 3.10 to 3.12 (default: this one)"
    )
    parser.add_argument("--output", type=Path, default=ROOT / "dist", help="folder of the wheel (default: dist)")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        wheel = plain_wheel(Path(folder))
        packages, targets = compiled(wheel, arguments.python, Path(folder))
        python = str(Path(folder) / "environment" / "bin" / "python")
        made = with_kernels(wheel, packages, python, targets, arguments.output.resolve())
        print(f"{made} has kernels for {' and '.join(targets)}: {made.stat().st_size / 1e6:.1f} MB, ", end="")
        print(f"{wheel.stat().st_size / 1e6:.1f} MB without")


if __name__ == "__main__":
    main()
