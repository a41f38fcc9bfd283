"""Every public member of the official client is called, and what comes of it stands in docs/supported.json."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from every_method.observe import PROCESSES, rows
from every_method.outcome import RECORD, Kind, Outcome, from_json
from every_method.parent import observe_all
from every_method.surface import surface
from linden.protocol.wire.client_functions import CARLA_FUNCTIONS
from linden.server.rpc import registry
from servers import running_server

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def outcomes(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Outcome]]:
    """What came of every call, against a server of its own."""
    recordings = tmp_path_factory.mktemp("recordings")
    with running_server("--recordings", str(recordings)) as running:
        yield observe_all(running.port)
        assert running.process.poll() is None, f"the server ended by itself: {running.log()}"
        assert "Traceback" not in running.log()


@pytest.fixture(scope="module")
def record() -> dict[str, Outcome]:
    """What the page says."""
    return from_json(Path(RECORD).read_text("utf-8"))


def test_every_public_member_of_the_wheel_has_a_row() -> None:
    members = [member for tables in PROCESSES for member in rows(tables)]
    assert sorted(members) == surface()


def test_every_remote_function_of_the_client_has_a_handler() -> None:
    registry.load_handlers()
    assert set(CARLA_FUNCTIONS) == set(registry.METHODS)


def test_every_call_works_or_is_refused_by_a_sentence(outcomes: dict[str, Outcome]) -> None:
    wrong = {member: found.sentence for member, found in outcomes.items() if found.kind is Kind.WRONG}
    assert not wrong


def test_only_sensors_are_put_off_to_a_later_version(outcomes: dict[str, Outcome]) -> None:
    put_off = {
        member: found.sentence
        for member, found in outcomes.items()
        if " yet" in found.sentence and "linden has no sensor." not in found.sentence
    }
    assert not put_off


def test_what_comes_of_every_call_is_what_the_page_says(
    outcomes: dict[str, Outcome], record: dict[str, Outcome]
) -> None:
    assert outcomes.keys() == record.keys()
    differing = {member: (found, record[member]) for member, found in outcomes.items() if found != record[member]}
    assert not differing, "run `make observe pages`, look at what has changed in docs/supported.md, and commit it"
