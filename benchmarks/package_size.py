"""What the base package of sensors.py takes on a disk: it is installed afresh, with all that it needs, and measured.

Bytecode is left out, which Python adds when it first reads a file, and so are compiled kernels and maps in the cache.
"""

import shutil
import subprocess
import sys
import tempfile
from importlib import metadata
from pathlib import Path

PROJECT = Path(__file__).parent.parent
SMALL_MIB = 5.0


def tell() -> None:
    """Install into a folder of its own and print what it holds, largest first."""
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as source:
        shutil.copytree(
            PROJECT / "src", Path(source, "src"), ignore=shutil.ignore_patterns("__pycache__", "*.egg-info")
        )
        for name in ("pyproject.toml", "README.md", "LICENSE"):
            shutil.copy(PROJECT / name, source)  # pip leaves what it built beside what it was built from
        command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-compile", "--target", folder, source]
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        if done.returncode:
            print(f"\nnot measured, for pip could not install it: {done.stderr.strip().splitlines()[-1:]}")
            return
        sizes = {found.name: mib(found) for found in metadata.distributions(path=[folder])}
        whole = sum(path.stat().st_size for path in Path(folder).rglob("*") if path.is_file()) / 2**20
    print(f"\n{'installed by pip install linden':<34}{'MiB':>8}")
    for name, size in sorted(sizes.items(), key=lambda item: -item[1]):
        if size >= SMALL_MIB or name == "linden":
            print(f"{name:<34}{size:>8.1f}")
    small = [size for name, size in sizes.items() if size < SMALL_MIB and name != "linden"]
    print(f"{f'{len(small)} of less than {SMALL_MIB:g}':<34}{sum(small):>8.1f}\n{'all':<34}{whole:>8.1f}")


def mib(found: metadata.Distribution) -> float:
    """Return the size of a distribution's files."""
    files = [Path(str(path.locate())) for path in found.files or ()]
    return sum(path.stat().st_size for path in files if path.exists()) / 2**20
