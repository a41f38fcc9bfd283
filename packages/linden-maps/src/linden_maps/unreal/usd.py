"""Parts of a map as USD (binary crate): metres, z up, one mesh for each part, with a subset for each material."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from linden.errors import UserError
from linden_maps.unreal.parts import Part, PartMaterial


def write_usd(parts: Sequence[Part], name: str, path: Path) -> None:
    """Write a .usdc file.

    Raises:
        UserError: the package usd-core is not installed.
    """
    try:
        from pxr import Sdf, Usd, UsdGeom, UsdShade, Vt  # noqa: PLC0415 - an optional part
    except ModuleNotFoundError:
        raise UserError(
            "writing USD needs usd-core; install it with: pip install 'linden-maps[unreal]', or add --no-usd"
        ) from None
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    root = UsdGeom.Xform.Define(stage, f"/{name}")
    stage.SetDefaultPrim(root.GetPrim())
    materials = {
        surface: _material(stage, f"/{name}/Materials/{surface.name}", surface, (Sdf, UsdShade))
        for surface in sorted({surface for part in parts for surface in part.surfaces})
    }
    for part in parts:
        mesh = UsdGeom.Mesh.Define(stage, f"/{name}/{part.name}")
        count = len(part.triangles)
        mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(part.vertices_m.astype(np.float32)))
        mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(count, 3, np.int32)))
        mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(part.triangles.astype(np.int32).reshape(-1)))
        mesh.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(part.normals.astype(np.float32)))
        mesh.SetNormalsInterpolation(UsdGeom.Tokens.uniform)
        mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
        mesh.CreateDoubleSidedAttr(True)
        texture = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, "faceVarying")
        texture.Set(Vt.Vec2fArray.FromNumpy(part.uv_m.reshape(-1, 2).astype(np.float32)))
        low, high = part.vertices_m.min(axis=0), part.vertices_m.max(axis=0)
        mesh.CreateExtentAttr(Vt.Vec3fArray.FromNumpy(np.stack([low, high]).astype(np.float32)))
        for row, surface in enumerate(part.surfaces):
            chosen = Vt.IntArray.FromNumpy(np.flatnonzero(part.surface == row).astype(np.int32))
            subset = UsdGeom.Subset.CreateGeomSubset(mesh, f"s{row}", UsdGeom.Tokens.face, chosen, "materialBind")
            UsdShade.MaterialBindingAPI.Apply(subset.GetPrim()).Bind(materials[surface])
    stage.GetRootLayer().Save()


def _material(stage: Any, path: str, surface: PartMaterial, modules: tuple[Any, Any]) -> Any:  # noqa: ANN401 - of usd-core
    sdf, shade = modules
    material = shade.Material.Define(stage, path)
    shader = shade.Shader.Define(stage, f"{path}/Surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    linear = tuple(round((value / 255.0) ** 2.2, 6) for value in surface.colour)
    shader.CreateInput("diffuseColor", sdf.ValueTypeNames.Color3f).Set(linear)
    shader.CreateInput("roughness", sdf.ValueTypeNames.Float).Set(0.9)
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    return material
