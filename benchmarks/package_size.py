"""What distributions take on a disk: each is installed afresh, with all that it needs, and measured.

Bytecode is left out, which Python adds when it first reads a file, and so are compiled kernels and maps in the cache.
"""

import shutil
import subprocess
import sys
import tempfile
from importlib import metadata
from pathlib import Path

PACKAGES = Path(__file__).parents[1] / "packages"
SMALL_MIB = 5.0
SETS = (("linden",), ("linden", "basu"))


def tell() -> None:
    """Install the server, and the server with the benchmark, each into a folder of its own; print what these hold."""
    for names in SETS:
        with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as source:
            for name in names:  # copies, for pip leaves what it built beside what it was built from
                ignored = shutil.ignore_patterns("__pycache__", "*.egg-info", "tests")
                shutil.copytree(PACKAGES / name, Path(source, name), ignore=ignored)
            sources = [str(Path(source, name)) for name in names]
            command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-compile", "--target", folder, *sources]
            done = subprocess.run(command, check=False, capture_output=True, text=True)
            if done.returncode:
                print(f"\nnot measured, for pip could not install it: {done.stderr.strip().splitlines()[-1:]}")
                return
            tell_of(Path(folder), names)


def tell_of(folder: Path, names: tuple[str, ...]) -> None:
    """Print what a folder of installed packages holds, largest first."""
    sizes = {found.name: mib(found) for found in metadata.distributions(path=[str(folder)])}
    whole = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file()) / 2**20
    print(f"\n{'installed by pip install ' + ' '.join(names):<40}{'MiB':>8}")
    for name, size in sorted(sizes.items(), key=lambda item: -item[1]):
        if size >= SMALL_MIB or name in names:
            print(f"{name:<40}{size:>8.1f}")
    small = [size for name, size in sizes.items() if size < SMALL_MIB and name not in names]
    print(f"{f'{len(small)} of less than {SMALL_MIB:g}':<40}{sum(small):>8.1f}\n{'all':<40}{whole:>8.1f}")


def mib(found: metadata.Distribution) -> float:
    """Return the size of a distribution's files."""
    files = [Path(str(path.locate())) for path in found.files or ()]
    return sum(path.stat().st_size for path in files if path.exists()) / 2**20
