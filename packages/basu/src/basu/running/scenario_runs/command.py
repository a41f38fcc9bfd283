"""``basu scenario run``: cases with agents, a folder each, and the matrix of all."""

from __future__ import annotations

import shlex
import sys
import time
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.errors import UserError
from basu.files import write_bytes
from basu.jobs.job import Job
from basu.jobs.playing import play_jobs
from basu.managers.agents_manager import ignored_wishes
from basu.metrics.registry import user_metrics
from basu.metrics.scoring import Scoring
from basu.outcome import Fault
from basu.output.progress import drives_bar
from basu.output.report.documents import CONFIG_FILE, make_draft, plain, point_latest, publish, write_json
from basu.output.report.scenarios.junit import junit_xml
from basu.output.report.scenarios.matrix_documents import MATRIX_FILE
from basu.output.report.scenarios.matrix_text import matrix_text
from basu.output.report.scenarios.page.matrix_page import PAGE_FILE, write_matrix_page
from basu.output.report.scenarios.page.suite_page import suite_page_file, write_suite_page
from basu.output.report.scenarios.suite_answers import answered, read_suites, suite_file, suite_text
from basu.output.report.scenarios.sweep.study import studies
from basu.output.report.scenarios.sweep.success_map import sweep_map
from basu.running.batch import Batch, counts
from basu.running.drive import DriveDone
from basu.running.folder_lock import locked
from basu.running.preparation import agent_of
from basu.running.scenario_runs.case_documents import matrix_of, run_config
from basu.running.scenario_runs.chosen_cases import suites_of
from basu.running.scenario_runs.player import case_player
from basu.running.scenario_runs.suite import MatrixDrives

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from basu.agents.loader import LoadedAgent
    from basu.agents.process.remote_agent import FoundAgent
    from basu.jobs.job import PlayerSpec
    from basu.running.scenario_runs.options import ScenarioOptions

TEXT_FILE, JUNIT_FILE = "matrix.txt", "junit.xml"
TIMES = "%Y-%m-%dT%H-%M-%S"


class MatrixRun(NamedTuple):
    """What a run of scenarios has written."""

    folder: Path
    matrix: dict[str, Any] | None  # None where nothing was played
    code: int  # the exit code of the worst verdict


def run_scenarios(options: ScenarioOptions, scoring: Scoring, resumed: Path | None = None) -> int:
    """Play all requested cases and show the matrix; the exit code is that of the worst verdict.

    ``resumed`` is the folder of a run that goes on.

    Raises:
        UserError: nothing can be played like this.
        SimulatorError: there is no simulator to play in.
    """
    played = play_matrix(options, scoring=scoring, resumed=resumed)
    if played.matrix is not None:
        _show(played.folder, played.matrix)
        print(f"repeat  basu scenario run --config {shlex.quote(str(played.folder / CONFIG_FILE))}")
    return played.code


def report_again(folder: Path, matrix: dict[str, Any], junit: Path | None) -> None:
    """Write the reports of a matrix into its folder again, and show it.

    Raises:
        UserError: the disk is full or the folder cannot be written.
    """
    _write_reports(folder, matrix, junit)
    _show(folder, matrix)


def _show(folder: Path, matrix: dict[str, Any]) -> None:
    print(matrix_text(matrix, colour=sys.stdout.isatty()))
    for document in read_suites(folder):
        print("\n" + "\n".join(suite_text(answered(folder, document, matrix))))
        print(f"suite   {folder / suite_page_file(document['name'])}")
    print(f"\nreport  {folder / PAGE_FILE}")


def play_matrix(
    options: ScenarioOptions,
    given: Mapping[str, LoadedAgent] | None = None,
    *,
    scoring: Scoring | None = None,
    resumed: Path | None = None,
    quiet: bool = False,
) -> MatrixRun:
    """Play every case with every agent and write the folder.

    ``given`` are agents' classes that are loaded, by name. ``resumed`` is the folder of a run that goes on.

    Raises:
        UserError: nothing can be played like this.
        SimulatorError: there is no simulator to play in.
    """
    scoring = scoring or Scoring()
    began, began_s = datetime.now(timezone.utc), time.perf_counter()
    suite = MatrixDrives(options, _loaded(options) if given is None else list(given.values()))
    for sentence in filter(None, map(ignored_wishes, suite.agents)):
        print(f"basu: warning: {sentence}", file=sys.stderr)
    user_metrics(options.metric_files)  # a file that holds no metric is refused before the drive
    if options.record_keys is not None and len(suite.drives) > 1:
        raise UserError(
            f"--record-keys records one drive, and these are {len(suite.drives)}; name one case and one agent"
        )
    folder = _folder(options, began) if resumed is None else resumed
    with locked(folder):
        if resumed is None:
            write_json(folder / CONFIG_FILE, run_config(options, scoring, suite.agents))
            for document in suites_of(options, {playable.case.name for playable, _ in suite.rows}):
                write_json(folder / suite_file(document["name"]), document)
        batch, matrix = Batch(folder, suite.names), None
        found = _taken_in(batch)
        # Classes that are given stay in this process: no other one has them.
        workers = 1 if options.needs_one_simulator or given is not None else options.workers
        try:
            code = _play(batch, suite, case_player(options, scoring, folder, given), workers, found, quiet=quiet)
        finally:
            batch.clear()
            if found:
                wall_s = time.perf_counter() - began_s
                matrix = matrix_of(options, suite.agent_names, suite.rows, found, folder, began, wall_s)
                write_json(folder / MATRIX_FILE, matrix)
                _write_reports(folder, matrix, options.junit)
    return MatrixRun(folder, matrix, code)


def _play(
    batch: Batch, suite: MatrixDrives, player: PlayerSpec, workers: int, found: dict[int, DriveDone], *, quiet: bool
) -> int:
    """Play the drives of a suite that are not in ``found``, and add them to it; return the exit code.

    Raises:
        UserError, SimulatorError: nothing can be played like this, or there is no simulator.
    """
    jobs = [Job(number, suite.job(number)) for number in range(len(suite.drives)) if number not in found]
    try:
        with drives_bar(len(jobs), " cases", quiet=quiet) as bar:
            for done in batch.play(play_jobs(player, jobs, workers), bar):
                found[done.number] = done if done.folder is not None else suite.lost(done)
    except KeyboardInterrupt:
        return int(Fault.USER.value)
    return worst(done.result.case for done in found.values() if done.result.case is not None)


def _taken_in(batch: Batch) -> dict[int, DriveDone]:
    """Return the drives that an earlier command has finished, by number; drives that do not count are set aside.

    Raises:
        UserError: a result is not what it should be, or the disk does not let us.
    """
    batch.clear()
    found = {}
    for number, result in list(batch.finished()):
        if counts(result):
            found[number] = DriveDone(batch.folder / batch.name(number), result, number=number)
        else:
            batch.set_aside(number, result)
    return found


def _write_reports(folder: Path, matrix: dict[str, Any], junit: Path | None) -> None:
    """Write the matrix as text, page and success maps into ``folder``, and as JUnit XML, to ``junit`` as well.

    Raises:
        UserError: the disk is full or the folder cannot be written.
    """
    write_bytes(folder / TEXT_FILE, f"{matrix_text(matrix)}\n".encode())
    for file in (folder / JUNIT_FILE, junit):
        if file is not None:
            write_bytes(file, junit_xml(matrix))
    for study in studies(matrix):
        name = f"success-{plain(study.scenario)}-{plain(study.agent)}.svg"
        write_bytes(folder / name, sweep_map(matrix, study.agent, study.scenario).encode())
    write_matrix_page(folder, matrix)
    for document in read_suites(folder):
        write_suite_page(folder, document, matrix)


def worst(documents: Iterable[Mapping[str, Any]]) -> int:
    """The exit code of what went worst: a simulator that failed before a set-up, before an agent."""
    return max({_exit_code(document) for document in documents}, default=Fault.SETUP.value)


def _exit_code(document: Mapping[str, Any]) -> int:
    """The agent's for a failure, and where nothing was exercised and the drive was not completed either."""
    absent = document["verdict"] == "NOT_EXERCISED" and document["assessment"]["completed"]["holds"] is False
    if document["verdict"] == "FAILURE" or absent:
        return Fault.AGENT.value
    return int(Fault[document["fault"].upper()].value)


def _loaded(options: ScenarioOptions) -> list[FoundAgent]:
    """The agents, loaded before anything begins, so that a wrong one is refused at once.

    Raises:
        UserError: one cannot be had, or two have one name.
    """
    agents = [agent_of(options, each) for each in options.agents]
    names = [agent.name for agent in agents]
    for name in names:
        if names.count(name) > 1:
            raise UserError(f"two agents are called '{name}'; name each once, or rename a file")
    return agents


def _folder(options: ScenarioOptions, began: datetime) -> Path:
    """A new folder for all of it."""
    what = plain("-".join(options.what))[:40]
    name = f"{began.astimezone():{TIMES}}-{what}"
    folder = publish(make_draft(options.output, name), name)
    point_latest(folder, options.output)
    return folder
