"""Compare the verdict of ASAM's checker on OpenSCENARIO files with ours, and list where they disagree.

usage: asam_verdicts.py --python PYTHON [--table FILE.md] FILE.xosc...

PYTHON is that of an environment with ``asam-qc-openscenarioxml``. A file is valid for the checker if it finds no error
in it, and for BASU if it is read, with the catalogs, the road network and all elements that it names.
"""

from __future__ import annotations

import argparse
import collections
import json
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

from basu.errors import BasuError
from basu_openscenario.playing.player import make_player
from basu_openscenario.reading.distributions import read_distribution
from basu_openscenario.reading.scenario_file import read_scenario

LONGEST_S = 30
CHECKER = f"""
import json, logging, resource, signal, sys
from qc_baselib import Configuration, IssueSeverity, Result
from qc_openscenario import constants
from qc_openscenario.main import run_checks

def late(*_):
    raise TimeoutError("longer than {LONGEST_S} s")

logging.disable(logging.CRITICAL)
resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))
signal.signal(signal.SIGALRM, late)
for path in sys.argv[1:]:
    config, result = Configuration(), Result()
    config.set_config_param("InputFile", path)
    config.register_checker_bundle(checker_bundle_name=constants.BUNDLE_NAME)
    result.register_checker_bundle(
        name=constants.BUNDLE_NAME, build_date="2026-01-01", description="", version="", summary=""
    )
    signal.alarm({LONGEST_S})
    try:
        run_checks(config, result)
        bundle = result._report_results.checker_bundles[0]
        found = [
            [checker.checker_id.rpartition("_xosc_")[2], issue.locations[0].description or issue.description]
            for checker in bundle.checkers
            for issue in checker.issues
            if issue.level == IssueSeverity.ERROR
        ]
        failed = [one.checker_id for one in bundle.checkers if str(one.status).lower().endswith("error")]
        print(json.dumps({{"issues": found, "failed": failed}}), flush=True)
    except BaseException as error:
        print(json.dumps({{"issues": [], "failed": [repr(error)[:200]]}}), flush=True)
    finally:
        signal.alarm(0)
"""


class Verdicts(NamedTuple):
    """What both say of a file; an empty sentence: nothing is wrong."""

    file: Path
    asam: str
    own: str

    @property
    def kind(self) -> str:
        """The agreement in words."""
        if bool(self.asam) == bool(self.own):
            return "both refuse" if self.asam else "both accept"
        return "only the checker refuses" if self.asam else "only BASU refuses"


def of_asam(python: Path, files: list[Path]) -> list[str]:
    """Return the first errors of the checker for each file, or that the checker itself failed."""
    command = [str(python), "-c", CHECKER, *map(str, files)]
    done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if len(lines) != len(files):
        raise SystemExit(f"the checker ended after {len(lines)} of {len(files)} files: {done.stderr[-500:]}")
    found = []
    for line in lines:
        document = json.loads(line)
        count = len(document["issues"])
        words = [f"{name}: {text}" for name, text in document["issues"][:1]]
        words += [f"the checker failed in {name}" for name in document["failed"]]
        found.append("; ".join(words) + (f" (and {count - 1} more)" if count > 1 else ""))
    return found


def of_basu(file: Path) -> str:
    """Return the sentence with which BASU refuses a file; empty where it is read."""
    try:
        distribution = read_distribution(file)
        if distribution is None:
            make_player(read_scenario(file), with_controllers=False)
        else:
            make_player(read_scenario(distribution.scenario, distribution.runs[0]), with_controllers=False)
    except BasuError as error:
        return str(error).replace(f"{file.parent}/", "")
    return ""


def main() -> int:
    """Compare the verdicts on the files."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--python", type=Path, required=True, help="of an environment with the checker")
    parser.add_argument("--table", type=Path, metavar="FILE.md", help="write the disagreements there")
    parser.add_argument("files", nargs="+", type=Path)
    arguments = parser.parse_args()
    files = [file.resolve() for file in arguments.files]
    asam = of_asam(arguments.python, files)
    verdicts = [Verdicts(file, said, of_basu(file)) for file, said in zip(files, asam, strict=True)]
    rows = []
    for one in verdicts:
        if one.kind.startswith("only"):
            name = f"{one.file.parent.name}/{one.file.name}"
            rows.append(f"| {name} | {one.kind} | {(one.asam or one.own).replace('|', '/')[:240]} |")
            print(rows[-1], flush=True)
    print(dict(collections.Counter(one.kind for one in verdicts)))
    if arguments.table is not None:
        head = "| file | verdicts | sentence |\n|---|---|---|\n"
        arguments.table.write_text(head + "\n".join(rows) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
