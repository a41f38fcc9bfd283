"""Calls every public member of the official client against a server and writes what came of it to docs/supported.json.

``make docs`` runs it before the page is written; tests/compat/test_every_method.py holds the record to the code.
"""

import sys
import tempfile
from pathlib import Path

TESTS = Path(__file__).parent.parent / "tests"
sys.path.insert(0, str(TESTS))

from every_method.outcome import RECORD, Kind, to_json  # noqa: E402 - what the tests hold is importable from here on
from every_method.parent import observe_all  # noqa: E402 - likewise
from servers import running_server  # noqa: E402 - likewise


def main() -> int:
    """Observe, write the record, and name whatever went wrong; 1 if anything did."""
    with tempfile.TemporaryDirectory() as folder, running_server("--recordings", folder) as server:
        outcomes = observe_all(server.port)
    wrong = {member: found for member, found in outcomes.items() if found.kind is Kind.WRONG}
    for member, found in wrong.items():
        print(f"{member}: {found.sentence}", file=sys.stderr)
    if not wrong:
        RECORD.write_text(to_json(outcomes), "utf-8")
    return 1 if wrong else 0


if __name__ == "__main__":
    raise SystemExit(main())
