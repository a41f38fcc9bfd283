"""Runs other people's CARLA programs, unmodified, against servers of ours, and prints what came of it.

``unshare --net --map-root-user python scripts/outside/run.py PROGRAMS TOWNS OSM SUMO_HOME OUT``, where
docs/reference/outside-programs.md says what lies in those folders. A network of its own gives every program CARLA's own
port 2000, and a fresh server behind it.
"""

import argparse
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from folders import Folders
from programs import PACE_S, Program, all_programs

START_LIMIT_S = 280.0
GRACE_S = 20.0
"""How long an interrupted program may take to tidy up."""
HERE = Path(__file__).parent


class Outcome(NamedTuple):
    """What came of one program."""

    ended: str
    """``by itself``, ``when interrupted``, or ``killed``."""
    status: int
    seconds: float
    output: str
    warnings: str
    """What the server logged meanwhile."""

    def has_failed(self, program: Program) -> bool:
        """Whether it did not do what it is for; ending on its own Ctrl+C is right for an endless one."""
        if self.ended == "killed" or (program.is_endless and self.ended == "by itself"):
            return True
        if self.ended == "when interrupted" and not program.is_endless:
            return True
        told = re.sub(r"Traceback(?:(?!Traceback).)*?KeyboardInterrupt", "", self.output, flags=re.DOTALL)
        return program.tells_failure in told or (self.ended == "by itself" and self.status != 0)


def main() -> int:
    """Run what was asked for; a line a program on stdout, everything else below the folder OUT."""
    parser = argparse.ArgumentParser(description=__doc__)
    for folder in Folders._fields:
        parser.add_argument(folder, type=Path)
    parser.add_argument(
        "--only", nargs="*", default=(), metavar="WORD", help="run only the rows that hold all of these"
    )
    parser.add_argument("--looked", action="store_true", help="let another client take a picture before each program")
    parser.add_argument("--python", default=sys.executable, help="the interpreter that has what the programs need")
    args = parser.parse_args()
    folders = Folders(*(getattr(args, folder).resolve() for folder in Folders._fields))
    signal.signal(signal.SIGINT, signal.default_int_handler)  # started with & it is ignored, and programs inherit that
    folders.out.mkdir(parents=True, exist_ok=True)
    subprocess.run(["ip", "link", "set", "lo", "up"], check=True)
    subprocess.run(["ip", "route", "add", "default", "dev", "lo"], check=True)  # config.py asks for a way out
    for program in all_programs(folders):
        if all(word in " ".join((program.family, program.town, *program.arguments)) for word in args.only):
            if program.town != "Linden" and not (folders.towns / f"{program.town}.xodr").exists():
                print(f"not run | {program.town} | {' '.join(program.arguments)} | no such map", flush=True)
                continue
            outcome = _run(program, folders, args.python, looked=args.looked)
            print(_line(program, outcome), flush=True)
    return 0


def _run(program: Program, folders: Folders, python: str, *, looked: bool) -> Outcome:
    """Start a server and the program, and wait for the end of it."""
    name = f"{program.town}_" + re.sub(r"[^A-Za-z0-9.=-]+", "_", "_".join(program.arguments))[-90:]
    log, output = folders.out / f"{name}.server.txt", folders.out / f"{name}.txt"
    pictures = folders.out / f"{name}.pictures"
    shutil.rmtree(pictures, ignore_errors=True)
    pictures.mkdir()
    watched = {"OUTSIDE_PICTURES": str(pictures), "OUTSIDE_KEYS": program.keys, "OUTSIDE_PACE_S": str(PACE_S)}
    command = [python, "-u", *(folders.filled(argument) for argument in program.arguments)]
    with _server(program, folders, log), _driver(program, python, folders, folders.out / f"{name}.driver.txt"):
        if looked:
            subprocess.run([python, str(HERE / "first_look.py"), str(program.port)], check=True)
        began_s = time.monotonic()
        with output.open("w", encoding="utf-8") as file:
            process = subprocess.Popen(
                command,
                cwd=folders.of(program.family),
                env={**_environment(folders), **watched},
                stdin=subprocess.DEVNULL,
                stdout=file,
                stderr=subprocess.STDOUT,
            )
            ended = _wait(process, program.limit_s)
        seconds = time.monotonic() - began_s
    outcome = Outcome(ended, process.returncode, seconds, _text(output), _text(log))
    verdict = "failed" if outcome.has_failed(program) else "ran"
    record = {"program": program._asdict(), "verdict": verdict, "status": outcome.status, "ended": ended}
    (folders.out / f"{name}.json").write_text(json.dumps(record), "utf-8")
    return outcome


def _wait(process: "subprocess.Popen[bytes]", limit_s: float) -> str:
    """Wait until it ends, or end it: politely first."""
    try:
        process.wait(limit_s)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGINT)
    else:
        return "by itself"
    try:
        process.wait(GRACE_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        return "killed"
    return "when interrupted"


@contextmanager
def _server(program: Program, folders: Folders, log: Path) -> Iterator[None]:
    """A server on the port on which an outside program expects it."""
    command = [sys.executable, "-m", "linden.cli", "serve", "--map", program.town, "--maps", str(folders.towns)]
    recordings = folders.of(program.family) if program.keeps_recordings else folders.out / "recordings"
    command += ["--port", str(program.port), "--recordings", str(recordings)]
    with log.open("w", encoding="utf-8") as file:
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=file, text=True)
    try:
        assert process.stdout is not None
        began_s = time.monotonic()
        while "ready" not in (line := process.stdout.readline()):
            if not line or time.monotonic() - began_s > START_LIMIT_S:
                break  # no such map: the program is run all the same, and says what a user would see
        yield
    finally:
        process.terminate()
        process.wait()


@contextmanager
def _driver(program: Program, python: str, folders: Folders, log: Path) -> Iterator[None]:
    """Somebody who drives the hero, if the program wants one: CARLA's own agent, in a client of its own."""
    if not program.needs_driver:
        yield
        return
    with log.open("w", encoding="utf-8") as file:
        process = subprocess.Popen(
            [python, str(HERE / "drive_hero.py")], stdout=file, stderr=file, env=_environment(folders)
        )
    try:
        yield
    finally:
        process.kill()
        process.wait()


def _environment(folders: Folders) -> dict[str, str]:
    """The variables that these programs' own manuals ask for, and no screen."""
    runner, api = folders.of("scenario_runner"), folders.programs / "carla" / "PythonAPI" / "carla"
    board = folders.of("leaderboard")
    wanted = {
        "PYTHONPATH": os.pathsep.join(map(str, (HERE / "watched", folders.sumo_home / "tools", api, runner, board))),
        "SCENARIO_RUNNER_ROOT": str(runner),
        "LEADERBOARD_ROOT": str(board),
        "SUMO_HOME": str(folders.sumo_home),
        "SDL_VIDEODRIVER": "dummy",
        "SDL_AUDIODRIVER": "dummy",
        "MPLBACKEND": "Agg",
    }
    return {**os.environ, **wanted}


def _text(path: Path) -> str:
    return path.read_text("utf-8", errors="replace")


def _line(program: Program, outcome: Outcome) -> str:
    """One row for the eye; the table of docs/reference/outside-programs.md is written from these by hand."""
    last = (outcome.output.strip().splitlines() or [""])[-1]
    verdict = "failed" if outcome.has_failed(program) else "ran"
    row = (
        verdict,
        program.town,
        " ".join(program.arguments),
        outcome.ended,
        f"{outcome.status}",
        f"{outcome.seconds:.0f} s",
    )
    return " | ".join((*row, last[:160]))


if __name__ == "__main__":
    raise SystemExit(main())
