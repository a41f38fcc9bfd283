"""Claims about ``--routes-subset``: ids, ranges in the file's order, and a sentence for every mistake."""

import pytest

from basu.errors import UserError
from basu.routing.route_file import RouteDescription
from basu.routing.subset import subset

ROUTES = [
    RouteDescription(id=name, town="T", points=(), stops=(), source="r.xml")
    for name in ("0", "1", "2", "3", "7", "24", "A-B")
]


@pytest.mark.parametrize(
    ("wanted", "ids"),
    [
        ("0-3,7", ["0", "1", "2", "3", "7"]),
        ("7, 0", ["0", "7"]),
        ("3-24", ["3", "7", "24"]),
        ("A-B", ["A-B"]),
        ("24-A-B", ["24", "A-B"]),
    ],
)
def test_ids_and_ranges_choose_routes_in_the_files_order(wanted: str, ids: list[str]) -> None:
    assert [route.id for route in subset(ROUTES, wanted)] == ids


@pytest.mark.parametrize(
    ("wanted", "sentence"),
    [
        ("5", "the route file has no '5'; it has 0, 1, 2, 3, 7, 24, A-B"),
        ("0-5", "the route file has no '0-5'"),
        ("", "the route file has no ''"),
        ("3-1", "'1' comes before '3' in the file"),
        ("0-3,2", "route '2' is named twice"),
    ],
)
def test_a_mistake_gets_a_sentence(wanted: str, sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        subset(ROUTES, wanted)
