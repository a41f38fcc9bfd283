"""Recorder log, OpenDRIVE map and criteria for metrics on CARLA recordings, from a run's folder or a recorder file."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

from basu.errors import UserError
from basu.files import loads
from basu.records.recording_files import LOG_FILE, MAP_FILE

RESULT_FILE, CONFIG_FILE = "result.json", "config.json"  # in a run's folder


class Source(NamedTuple):
    """Files of one recording; None where there is none."""

    log: Path
    map: Path | None
    result: Path | None


def source(run_or_log: Path, map_file: Path | None = None) -> Source:
    """The files of a run's folder or of a recorder file; ``map_file`` goes before what lies there.

    Raises:
        UserError: there is no log, or ``map_file`` is not there.
    """
    if map_file is not None and not map_file.is_file():
        raise UserError(f"the map {map_file} is not there; name an OpenDRIVE file (.xodr)")
    if run_or_log.is_dir():
        log = run_or_log / LOG_FILE
        if not log.is_file():
            raise UserError(f"{run_or_log} has no {LOG_FILE}: {_why_no_log(run_or_log / CONFIG_FILE)}")
        return Source(log, map_file or _there(run_or_log / MAP_FILE), _there(run_or_log / RESULT_FILE))
    if not run_or_log.exists():
        raise UserError(f"{run_or_log} is not there; name a run's folder, such as runs/latest, or a recorder file")
    if run_or_log.name == LOG_FILE:  # its run lies around it
        return source(run_or_log.parent, map_file)
    return Source(run_or_log, map_file, None)


class AbsentMap:
    """Replaces a missing map; any use of it raises an error."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, wanted: str) -> Any:  # noqa: ANN401 - whatever a map has
        """Raises: UserError, which says how to give the map."""
        raise UserError(
            f"the metric asks for {wanted} of the map {self._name}, which is not with the recording; "
            f"give it with --map {Path(self._name).name}.xodr"
        )


def read_criteria(path: Path) -> dict[str, Any]:
    """Criteria as ScenarioRunner writes them beside its log.

    What it calls ``expected_value_success`` is there as ``success_value`` too, which its own example still asks for.

    Raises:
        UserError: it is no JSON object.
    """
    try:
        document = loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UserError(f"the criteria {path} cannot be read: {error}; name a JSON file") from error
    if not isinstance(document, dict):
        raise UserError(f"the criteria {path} are no JSON object; name what ScenarioRunner's --record wrote")
    for criterion in document.values():
        if isinstance(criterion, dict) and "expected_value_success" in criterion:
            criterion.setdefault("success_value", criterion["expected_value_success"])
    return document


def criteria_of(result: Path) -> dict[str, Any]:
    """Return the judgement of a drive of ours in the form of ScenarioRunner's criteria.

    There is a test for each kind of infraction, and for each criterion of a case.

    Raises:
        UserError: it is no result of a run.
    """
    try:
        document = loads(result.read_text(encoding="utf-8"))
        kinds = [row["kind"] for row in document["infractions"]]
        judged = sorted({*document["scoring"]["penalties"], *kinds})
        criteria = document.get("case", {}).get("judgements", [])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise UserError(f"{result} is not the result of a run: {error!r}") from error
    infractions = {
        kind: {
            "test_status": "FAILURE" if kinds.count(kind) else "SUCCESS",
            "actual_value": kinds.count(kind),
            "success_value": 0,
            "expected_value_success": 0,
        }
        for kind in judged
    }
    of_case = {
        said["criterion"]: {
            "test_status": {True: "SUCCESS", False: "FAILURE", None: "NOT_JUDGED"}[said["passed"]],
            "actual_value": said["measured"],
            "success_value": said["limit"],
            "expected_value_success": said["limit"],
        }
        for said in criteria
    }
    return {**infractions, **of_case}


def _why_no_log(config: Path) -> str:
    """What a run's config says about its log, and what to do."""
    try:
        recorded = loads(config.read_text(encoding="utf-8"))["recording"]
        return f"it is {recorded['file']} ({recorded['where']}); copy it here under that name"
    except (OSError, ValueError, KeyError, TypeError):
        return "the run was not recorded; run it with --record"


def _there(path: Path) -> Path | None:
    return path if path.is_file() else None
