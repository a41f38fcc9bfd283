"""SUMO's own programs: where the wheel has put them, how one is run, and what its complaints mean."""

import importlib.util
import os
import subprocess
from collections.abc import Sequence
from pathlib import Path

from linden.errors import UserError

LIMIT_S = 600.0  # netconvert takes 2 s for Linden


def home() -> Path:
    """Return SUMO's folder: SUMO_HOME where that is set, else the one of the wheel.

    Raises:
        UserError: SUMO is not installed.
    """
    given = os.environ.get("SUMO_HOME")
    if given and (Path(given) / "bin").is_dir():
        return Path(given)
    found = importlib.util.find_spec("sumo")
    if found is None or found.origin is None:
        raise UserError("SUMO is not installed; install it with: pip install 'linden-maps[sumo]'")
    return Path(found.origin).parent


def run(program: str, arguments: Sequence[str | Path], folder: Path) -> None:
    """Run one of SUMO's programs in ``folder``.

    Raises:
        UserError: SUMO is not installed, or the program refused its input.
    """
    place = home()
    suffix = ".exe" if os.name == "nt" else ""
    command = [str(place / "bin" / f"{program}{suffix}"), *map(str, arguments)]
    try:
        done = subprocess.run(  # noqa: S603 - SUMO's own program with arguments of ours
            command,
            cwd=folder,
            env={**os.environ, "SUMO_HOME": str(place)},
            capture_output=True,
            text=True,
            timeout=LIMIT_S,
            check=False,
        )
    except OSError as error:
        again = "reinstall with: pip install 'linden-maps[sumo]'"
        raise UserError(f"SUMO's {program} cannot be run: {error.strerror}; {again}") from None
    except subprocess.TimeoutExpired:
        raise UserError(f"SUMO's {program} did not end within {LIMIT_S:.0f} s; give it a smaller map") from None
    if done.returncode != 0:
        errors = [line for line in done.stderr.splitlines() if line.startswith("Error")] or done.stderr.splitlines()
        said = errors[0] if errors else f"exit status {done.returncode}"
        raise UserError(f"SUMO's {program} refused the map: {said}")
