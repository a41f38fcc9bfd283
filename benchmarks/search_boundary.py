"""A boundary found by a search beside a grid of the same space: how often they agree, and both pictures side by side.

usage: search_boundary.py GRID SEARCH [--page OUT.html]

Both are folders of campaigns with one case, one agent and two parameters. Every drive of the grid is a verdict that the
search's surrogate foretells.
"""

import argparse
from pathlib import Path

import numpy as np

from basu.campaigns.drive_table import read_drives
from basu.campaigns.report import studies_of
from basu.output.report.scenarios.sweep.boundary import boundary_of
from basu.output.report.scenarios.sweep.success_map import drawing, map_style
from basu.output.report.templates import html
from basu_search.boundary_map import boundary_map
from basu_search.findings import MAY, SURE, boundary_in, searches_in

STYLE = "body { display: flex; gap: 16px; margin: 8px; font: 15px sans-serif } figure { margin: 0; width: 640px }"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("grid", type=Path)
    parser.add_argument("search", type=Path)
    parser.add_argument("--page", type=Path)
    given = parser.parse_args()
    grid = read_drives(given.grid)
    (drives,) = searches_in(given.search, read_drives(given.search))
    found = boundary_in(drives)
    assert found.surrogate is not None
    assert found.share is not None
    rows = [row for row in grid.to_pylist() if row["judged"]]
    at = np.array(
        [[(row[f"parameter_{each.name}"] - each.low) / (each.high - each.low) for each in drives.space] for row in rows]
    )
    failed = np.array([not row["success"] for row in rows])
    side = found.surrogate.failing(at)
    is_sure = (side > SURE) | (side < MAY)
    right = (side > 0.5) == failed
    print(f"grid: {grid.num_rows} drives, {len(rows)} judged, {failed.mean():.1%} of them failed")
    print(f"search: {len(drives.failed)} drives; failures take up {found.share.value:.1%} of the space, "
          f"surely {found.share.low:.1%}, at most {found.share.high:.1%}")  # fmt: skip
    print(f"the search foretells {right.mean():.1%} of the grid's verdicts; outside its band, which holds "
          f"{(~is_sure).mean():.1%} of them, {right[is_sure].mean():.1%}")  # fmt: skip
    if given.page is not None:
        (study,) = studies_of(grid, [drives.about["agent"]])
        order = [each.name for each in drives.space]  # both pictures have the same axes
        study = study._replace(axes=sorted(study.axes, key=lambda axis: order.index(axis.name)))
        pictures = [drawing(boundary_of(study)), boundary_map(found)]
        heads = [f"grid, {grid.num_rows} drives", f"search, {len(drives.failed)} drives"]
        figures = "".join(
            f"<figure><figcaption>{head}</figcaption>{html(picture)}</figure>"
            for head, picture in zip(heads, pictures, strict=True)
            if picture is not None
        )
        given.page.write_text(f"<meta charset=utf-8><style>{STYLE}\n{map_style()}</style>{figures}", encoding="utf-8")


if __name__ == "__main__":
    main()
