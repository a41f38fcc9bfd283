"""ASAM's checker of OpenDRIVE (``asam-qc-opendrive``), run over a map's bytes: what it has to say, a line each."""

import logging
from pathlib import Path
from tempfile import TemporaryDirectory

from qc_baselib import Configuration, Result, StatusType
from qc_opendrive import constants
from qc_opendrive.main import run_checks


def issues(xodr: bytes) -> list[str]:
    """Return each issue with the rule that is broken; a rule that fails to run is one too."""
    result = Result()
    result.register_checker_bundle(name=constants.BUNDLE_NAME, description="", version="1.0.0", summary="")
    result.set_result_version(version="1.0.0")
    before = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        with TemporaryDirectory() as folder:
            file = Path(folder) / "map.xodr"
            file.write_bytes(xodr)
            config = Configuration()
            config.set_config_param("InputFile", str(file))
            run_checks(config, result)
    finally:
        logging.disable(before)
    found = []
    for rule in result.get_checker_ids(constants.BUNDLE_NAME):
        if result.get_checker_status(rule) is StatusType.ERROR:
            found.append(f"{rule} ended in an error")
        found += [f"{rule}: {one.description}" for one in result.get_issues(constants.BUNDLE_NAME, rule)]
    return found
