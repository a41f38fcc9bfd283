"""Claims about exit codes: the party at fault comes first, then a score that is too low."""

import pytest

from basu.cli import main
from basu.errors import UserError
from basu.options.run import RunOptions
from basu.outcome import Status
from basu.running.exit_code import exit_code

GOOD = {"driving": 0.995, "infraction": 1.0, "path_following": 0.98}


def test_a_score_that_is_high_enough_leaves_the_code_of_the_outcome() -> None:
    assert exit_code(Status.COMPLETED, GOOD, {"driving": 0.99}) == 0
    assert exit_code(Status.ROUTE_TIMEOUT, GOOD, {"driving": 0.99}) == 1
    assert exit_code(Status.SIMULATOR_FAILED, None, {"driving": 0.99}) == 3


def test_a_score_that_is_too_low_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_code(Status.COMPLETED, GOOD, {"driving": 0.99, "path_following": 0.99}) == 1
    assert capsys.readouterr().out == "basu: the score path_following is 0.98; --require asks for 0.99 or more\n"


def test_a_run_without_a_score_reaches_none() -> None:
    assert exit_code(Status.COMPLETED, None, {"driving": 0.5}) == 1
    assert exit_code(Status.COMPLETED, None, {"driving": 0.0}) == 0


def test_a_score_that_does_not_exist_is_refused() -> None:
    with pytest.raises(UserError, match="--require drivin: there is no such score; did you mean 'driving'"):
        RunOptions(require={"drivin": 0.5}).check()


@pytest.mark.parametrize("text", ["driving", "driving=high", "driving=1.5", "comfort=1"])
def test_what_is_typed_wrongly_is_one_sentence(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "basic", "--require", text]) == 2
    assert capsys.readouterr().err.startswith("basu: --require")
