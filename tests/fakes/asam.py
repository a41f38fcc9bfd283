"""ASAM's checkers of OpenDRIVE and OpenSCENARIO: what they have to say about a file, a line each."""

import logging
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import qc_opendrive.constants
import qc_opendrive.main
import qc_openscenario.constants
import qc_openscenario.main
from qc_baselib import Configuration, Result, StatusType


def issues(xodr: bytes) -> list[str]:
    """Return each issue of a map with the rule that is broken; a rule that fails to run is one too."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / "map.xodr"
        file.write_bytes(xodr)
        return _issues(qc_opendrive.constants.BUNDLE_NAME, qc_opendrive.main.run_checks, file)


def scenario_issues(file: Path) -> list[str]:
    """Return each issue of an OpenSCENARIO file, likewise; the road network stands beside it."""
    return _issues(qc_openscenario.constants.BUNDLE_NAME, qc_openscenario.main.run_checks, file)


def _issues(bundle: str, run_checks: Callable[[Configuration, Result], None], file: Path) -> list[str]:
    result = Result()
    result.register_checker_bundle(name=bundle, description="", version="1.0.0", summary="")
    result.set_result_version(version="1.0.0")
    before = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        config = Configuration()
        config.set_config_param("InputFile", str(file))
        run_checks(config, result)
    finally:
        logging.disable(before)
    found = []
    for rule in result.get_checker_ids(bundle):
        if result.get_checker_status(rule) is StatusType.ERROR:
            found.append(f"{rule} ended in an error")
        found += [f"{rule}: {one.description}" for one in result.get_issues(bundle, rule)]
    return found
