"""Installs each distribution into an empty environment of its own, uses it for its main purpose, and prints a table.

    python scripts/alone.py [DISTRIBUTION ...] [--parts]

The wheels of this repository are built once. An environment gets the wheel of one distribution, those of this
repository that it requires, and everything else by pip within ``constraints.txt``. Sizes are of installed files without
bytecode, which Python adds when it first reads a file. ``--parts`` prints the largest parts of each environment as
well. The exit status is 1 where a use fails; then the last lines that it said follow the table.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
import venv
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

from build_wheel import PIP, ROOT, plain_wheel, with_kernels

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

sys.path.append(str(ROOT / "tests"))

from linden.compiled import TARGET
from openscenario_texts import scenario, written

PACKAGES = ROOT / "packages"
SHORT_ROUTE = ROOT / "packages/basu/src/basu/routes/linden_short.xml"
SMALL_MIB = 5.0
LIMIT_S = 900.0
BASIC = "basu run basic --routes piece.xml --no-scenarios --stop-after 3"
SERVED = """
import msgpack, socket, subprocess, sys
serve = [sys.executable, "-m", "linden.cli", "serve", "--port", "0", "--sync", *sys.argv[1:]]
with subprocess.Popen(serve, stdout=subprocess.PIPE, text=True) as server:
    for line in server.stdout:
        print(line, end="")
        if line.startswith("linden: ready"):
            break
    with socket.create_connection(("127.0.0.1", int(line.split("rpc port ")[1].split(",")[0]))) as client:
        for call in ([0, 1, "version", [[False]]], [0, 2, "tick_cue", [[False]]]):
            client.sendall(msgpack.packb(call))
            print(msgpack.unpackb(client.recv(65536)))
    server.terminate()
"""
MANY = """
import gymnasium, linden_gym, numpy as np
worlds = gymnasium.make_vec("linden/Shuttle-v0", num_envs=100)
worlds.reset(seed=1)
for _ in range(10):
    seen, rewards, *_ = worlds.step(np.zeros((100, 2), np.float32))
print(rewards.shape)
"""
SEARCH = """
name = "search"
agents = ["basic"]
[seeds]
first = 0
number = 1
[[drives]]
cases = ["red_light_runner_1"]
vary = ["speed", "lateness"]
search = {drives = 26, first = 10, batch = 4}
"""
POLICY = """
import re, subprocess, sys
serve = ["basu", "serve", "egodriver", "basic", "--port", "0"]
with subprocess.Popen(serve, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as policy:
    for line in policy.stdout:
        print(line, end="")
        if found := re.search(r"127[.]0[.]0[.]1:[0-9]+", line):
            break
    run = ["basu", "run", "egodriver:" + found[0], *sys.argv[1:]]
    code = subprocess.run(run).returncode
    policy.terminate()
sys.exit(code)
"""
PAGE = """
import subprocess
with subprocess.Popen(["basu", "watch", "runs/latest"], stdout=subprocess.PIPE, text=True) as page:
    print(page.stdout.readline())
    page.terminate()
"""


class Use(NamedTuple):
    """What a distribution is for."""

    commands: str
    """Lines for a shell, in a folder that has the files of ``made_files``."""
    told: str
    """What they say where it works."""


USES = {
    "linden": Use("python served.py", "0.9.16"),
    "linden-maps": Use("linden map build quarter.osm -o quarter.xodr && linden map info quarter.xodr", "roads"),
    "linden-window": Use("python served.py --window", "linden: window http://127.0.0.1"),
    "linden-ros2": Use("python served.py --ros2", "linden: ROS 2"),
    "linden-gym": Use("python many.py", "(100,)"),
    "basu": Use(BASIC, "score"),
    "basu-alpasim": Use(f"python policy.py {BASIC.removeprefix('basu run basic')}", "score"),
    "basu-carla-log": Use(
        f"{BASIC} --record && basu metrics runs/latest --metric collisions.py", "nobody touched anything"
    ),
    "basu-leaderboard": Use(BASIC.replace("basic", "leaderboard_agent.py"), "score"),
    "basu-openscenario": Use("basu scenario run drive.xosc", "drive"),
    "basu-ros": Use(f"{BASIC} --rosbag", "score"),
    "basu-search": Use("basu campaign run search.toml --dry-run", "26"),
    "basu-service": Use(f"{BASIC} && basu service falls runs/latest", "of 100"),
    "basu-sumo": Use(f"{BASIC} --sumo random --vehicles 5", "score"),
    "basu-truth": Use(
        f"{BASIC} --record && basu truth export runs/latest --sensors sensors.json --format coco -o truth", "frame"
    ),
    "basu-window": Use(f"{BASIC} --record && python page.py", "http://127.0.0.1"),
}


def piece_of_route() -> str:
    """Return a routes file with the first three points of a route of BASU."""
    lines = SHORT_ROUTE.read_text(encoding="utf-8").splitlines()
    points = "".join([line for line in lines if "<position" in line or "<waypoint " in line][:3])
    return f'<routes><route id="piece" town="Linden"><waypoints>{points}</waypoints></route></routes>'


def made_files(folder: Path) -> None:
    """Write the files that the uses need."""
    texts = {"piece.xml": piece_of_route(), "served.py": SERVED, "many.py": MANY, "search.toml": SEARCH}
    texts |= {"policy.py": POLICY, "page.py": PAGE}
    written(folder, scenario(), "drive.xosc")
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    for name in ("maps/quarter.osm", "metrics/collisions.py", "truth/sensors.json", "leaderboard_agent.py"):
        shutil.copy(ROOT / "examples" / name, folder)


def required(distribution: str) -> list[str]:
    """Return a distribution and those of this repository that it requires."""
    found = [distribution]
    for each in found:
        project = tomllib.loads((PACKAGES / each / "pyproject.toml").read_text(encoding="utf-8"))["project"]
        names = [text.split("=")[0].split("[")[0] for text in project["dependencies"]]
        found += [name for name in names if name in USES and name not in found]
    return found


def tried(distribution: str, wheels: dict[str, Path], folder: Path, *, parts: bool) -> str:
    """Install a distribution, use it, and print its row. Return what the use said where it failed, else nothing."""
    environment, place = folder / "environment", folder / "place"
    venv.create(environment, with_pip=False)
    place.mkdir()
    made_files(place)
    project = tomllib.loads((PACKAGES / distribution / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extra = next((text.partition("[")[2].partition("]")[0] for text in project["dependencies"] if "[" in text), "")
    own = [
        f"{wheels[name]}[{extra}]" if extra and name == "basu" else str(wheels[name]) for name in required(distribution)
    ]
    python = str(environment / "bin" / "python")
    install = [*PIP, "--python", python, "install", "--no-compile", "--constraint", str(ROOT / "constraints.txt"), *own]
    subprocess.run([sys.executable, *install], check=True)
    packages = next(environment.glob("lib/python*/site-packages"))
    whole = sum(path.stat().st_size for path in packages.rglob("*") if path.is_file()) / 2**20
    largest = sizes(packages) if parts else {}
    names = {"PATH": f"{environment / 'bin'}{os.pathsep}{os.defpath}", "HOME": str(place), "LANG": "C.UTF-8"}
    began_s = time.monotonic()
    done = subprocess.run(
        ["bash", "-c", USES[distribution].commands],
        cwd=place,
        env=names,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=LIMIT_S,
        check=False,
    )
    works = done.returncode == 0 and USES[distribution].told in done.stdout
    took_s = time.monotonic() - began_s
    print(f"{distribution:<20}{whole:>8.0f}{took_s:>8.0f}  {'works' if works else 'FAILS'}", flush=True)
    for name, size in largest.items():
        print(f"    {name:<40}{size:>8.1f}")
    return "" if works else done.stdout


def sizes(packages: Path) -> dict[str, float]:
    """Return the sizes of the larger installed distributions in MiB, the largest first."""
    found = {each.name: mib(each) for each in metadata.distributions(path=[str(packages)])}
    return {name: size for name, size in sorted(found.items(), key=lambda item: -item[1]) if size >= SMALL_MIB}


def mib(found: metadata.Distribution) -> float:
    """Return the size of a distribution's files."""
    files = [Path(str(path.locate())) for path in found.files or ()]
    return sum(path.stat().st_size for path in files if path.exists()) / 2**20


def main() -> int:
    """Try the distributions that are named, or all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("distributions", nargs="*", metavar="DISTRIBUTION", help="those to try (default: all)")
    parser.add_argument("--parts", action="store_true", help="print the largest parts of each environment")
    options = parser.parse_args()
    unknown = [name for name in options.distributions if name not in USES]
    if unknown:
        parser.error(f"no distribution here is called {unknown[0]}: choose from {', '.join(USES)}")
    failures = {}
    with tempfile.TemporaryDirectory() as folder:
        chosen = options.distributions or list(USES)
        wheels = {name: plain_wheel(Path(folder), name) for name in {each for one in chosen for each in required(one)}}
        wheels["linden"] = with_kernels(
            wheels["linden"], PACKAGES / "linden" / "src", sys.executable, [TARGET], Path(folder, "with-kernels")
        )
        print(f"{'distribution':<20}{'MiB':>8}{'use, s':>8}")
        for name in chosen:
            with tempfile.TemporaryDirectory() as place:
                failures[name] = tried(name, wheels, Path(place), parts=options.parts)
    for name, said in failures.items():
        if said:
            print(f"\n{name}: {USES[name].commands}\n" + "\n".join(said.splitlines()[-20:]))
    return int(any(failures.values()))


if __name__ == "__main__":
    sys.exit(main())
