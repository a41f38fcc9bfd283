"""Claims about the package's files, opened by readers that are not ours: two for FBX, one each for glTF and USD."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import assimp_py
import numpy as np
import pytest
from pxr import Usd, UsdGeom, UsdShade

from linden.cli import main
from linden.errors import UserError
from linden_maps.unreal.fbx import fbx
from linden_maps.unreal.package import names_of, write_package
from linden_maps.unreal.parts import Part
from opendrive_texts import street_through_junction


@pytest.fixture(scope="module")
def folder(parts: list[Part], tmp_path_factory: pytest.TempPathFactory) -> Path:
    stage = tmp_path_factory.mktemp("package")
    write_package(stage, names_of("Town"), b"<OpenDRIVE/>", parts, usd=True)
    return stage


@pytest.fixture(scope="module")
def by_ufbx(folder: Path) -> Any:
    command = [sys.executable, "-m", "fakes.fbx_reader", str(folder / "Town" / "Town.fbx")]
    tests = str(Path(__file__).parents[4] / "tests")
    ended = subprocess.run(command, check=True, capture_output=True, text=True, env={"PYTHONPATH": tests})
    return json.loads(ended.stdout)


@pytest.fixture(scope="module")
def by_assimp(folder: Path) -> Any:
    return assimp_py.import_file(str(folder / "Town" / "Town.fbx"), assimp_py.Process_Triangulate)


def test_fbx_is_binary_7_4_in_centimetres_with_z_up(by_ufbx: Any) -> None:
    assert (by_ufbx["version"], by_ufbx["is_ascii"]) == (7400, False)
    assert by_ufbx["unit_m"] == pytest.approx(0.01)
    assert by_ufbx["axes"] == ["POSITIVE_X", "POSITIVE_Z", "NEGATIVE_Y"]


def test_the_first_reader_finds_every_part_with_its_triangles(by_ufbx: Any, parts: list[Part]) -> None:
    assert by_ufbx["meshes"] == {
        part.name: [len(part.triangles), len(part.vertices_m), len(part.surfaces), True, True] for part in parts
    }


def test_the_second_reader_finds_the_same_places_and_normals(by_assimp: Any, parts: list[Part]) -> None:
    for part in parts:
        of_part = [mesh for mesh in by_assimp.meshes if mesh.name == part.name]
        places = np.concatenate([np.array(mesh.vertices).reshape(-1, 3) for mesh in of_part])
        normals = np.concatenate([np.array(mesh.normals).reshape(-1, 3) for mesh in of_part])
        np.testing.assert_allclose(places.min(axis=0), 100.0 * part.vertices_m.min(axis=0), atol=0.01)
        np.testing.assert_allclose(places.max(axis=0), 100.0 * part.vertices_m.max(axis=0), atol=0.01)
        assert {tuple(row) for row in normals.round(3)} == {tuple(row) for row in (part.normals + 0.0).round(3)}
        assert all(len(mesh.texcoords) == 1 for mesh in of_part)


def test_materials_have_names_and_colours(by_assimp: Any, parts: list[Part]) -> None:
    found = {material["NAME"]: material["COLOR_DIFFUSE"] for material in by_assimp.materials}
    for surface in {surface for part in parts for surface in part.surfaces}:
        assert found[surface.name] == pytest.approx([value / 255.0 for value in surface.colour], abs=1e-5)


def test_gltf_has_the_same_parts(folder: Path, parts: list[Part]) -> None:
    scene = assimp_py.import_file(str(folder / "Town" / "Town.glb"), 0)
    assert {mesh.name.split("-")[0] for mesh in scene.meshes} == {part.name for part in parts}
    assert sum(mesh.num_faces for mesh in scene.meshes) == sum(len(part.triangles) for part in parts)


def test_usd_has_the_same_parts_in_metres(folder: Path, parts: list[Part]) -> None:
    stage = Usd.Stage.Open(str(folder / "Town" / "Town.usdc"))
    assert UsdGeom.GetStageUpAxis(stage) == "Z"
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0
    meshes = {prim.GetName(): UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)}
    assert set(meshes) == {part.name for part in parts}
    for part in parts:
        mesh = meshes[part.name]
        np.testing.assert_allclose(mesh.GetPointsAttr().Get(), part.vertices_m, atol=1e-4)
        for subset in UsdGeom.Subset.GetAllGeomSubsets(mesh):
            material, _ = UsdShade.MaterialBindingAPI(subset.GetPrim()).ComputeBoundMaterial()
            assert material


def test_equal_parts_give_equal_bytes(parts: list[Part]) -> None:
    assert fbx(parts, "Town") == fbx(parts, "Town")


def test_the_only_json_is_the_description(folder: Path) -> None:
    """CARLA's importer takes every .json for one."""
    (description,) = folder.rglob("*.json")
    (one,) = json.loads(description.read_text())["maps"]
    assert description.name == "TownPackage.json"
    assert all((folder / one[key]).is_file() for key in ("source", "xodr"))
    assert Path(one["source"]).stem == Path(one["xodr"]).stem == one["name"]


def test_a_name_that_unreal_does_not_take_is_refused() -> None:
    with pytest.raises(UserError, match="is no name for a map in Unreal; rename the file"):
        names_of("my town")


def test_the_command_writes_the_package_of_a_map(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = tmp_path / "street.xodr"
    source.write_text(street_through_junction())
    out = tmp_path / "out"
    assert main(["map", "package", str(source), "--for", "carla", "-o", str(out)]) == 0
    assert (out / "street" / "street.xodr").read_bytes() == source.read_bytes()
    assert {path.name for path in (out / "street").iterdir()} == {
        f"street.{end}" for end in ("xodr", "fbx", "glb", "usdc")
    }
    assert "semantic groups" in capsys.readouterr().out


def test_a_folder_with_other_files_is_left_as_it_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = tmp_path / "street.xodr"
    source.write_text(street_through_junction())
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "mine.txt").write_text("kept")
    assert main(["map", "package", str(source), "--for", "carla", "-o", str(tmp_path / "out")]) == 2
    assert "mine.txt" in capsys.readouterr().err
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["mine.txt"]
