"""One command writes a map and the routes over it."""

import json
import sys
from pathlib import Path
from typing import Any

import pytest

from linden_maps.streets.__main__ import main
from linden_maps.streets.build import build


def test_map_and_routes_are_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, sketch: Any) -> None:
    features = sketch.crossing()
    line = features[0]["geometry"]
    way = {"type": "Feature", "geometry": line, "properties": {"feature": "route", "id": "way"}}
    town = sketch.collection([*features, way])
    streets, xodr, route = (tmp_path / name for name in ("town.geojson", "Town.xodr", "way.xml"))
    streets.write_text(json.dumps(town), encoding="utf-8")
    monkeypatch.setattr(sys, "argv", ["mapping", str(streets), "-o", str(xodr), "--route", f"way={route}"])
    main()
    assert xodr.read_bytes() == build(town)
    assert b'<route id="0" town="Town" name="way">' in route.read_bytes()
