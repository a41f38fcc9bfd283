"""Claims about runs at the same time: what they cannot share is refused, and results are those of one worker."""

import json
from pathlib import Path

import pytest

from basu.cli import main
from basu.errors import UserError
from basu.options.run import RunOptions
from basu.running.runner import check_parallel

VOLATILE = {"wall_s", "started", "first_server_frame"}  # of the meta: times, and the age of the server


@pytest.mark.parametrize(
    "options",
    [RunOptions(workers=2, host="localhost"), RunOptions(workers=2, watch=True), RunOptions(workers=2, keys="a.json")],
)
def test_what_runs_cannot_share_is_refused(options: RunOptions) -> None:
    with pytest.raises(UserError, match="--workers"):
        check_parallel(options)


@pytest.mark.usefixtures("one_server")
def test_a_series_of_two_workers_equals_one_of_one(
    tmp_path: Path, route_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["run", "forward", "--in-process", "--routes", str(route_file), "--stop-after", "3", "--repetitions", "2"]
    for name, workers in (("one", "1"), ("two", "2")):
        assert main([*words, "--series", name, "--workers", workers]) == 0

    def results(name: str) -> list[dict[str, object]]:
        series = json.loads((tmp_path / "runs" / name / "series.json").read_text(encoding="utf-8"))
        assert len(series["runs"]) == 2
        found = []
        for row in series["runs"]:
            document = json.loads(
                (tmp_path / "runs" / name / row["folder"] / "result.json").read_text(encoding="utf-8")
            )
            meta = {key: value for key, value in document.pop("meta").items() if key not in VOLATILE}
            found.append({**document, "meta": meta})
        return found

    assert results("one") == results("two")
