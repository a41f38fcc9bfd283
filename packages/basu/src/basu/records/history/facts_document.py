"""`FactsDocument`: the fields, types and bounds of ``route.json``, checked before the record is used.

A run's folder may come from another person or machine, so each value is checked here and not where it is used.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, model_validator

from basu.routing.planned_route import LEAST_POINTS


def _width(value: float) -> float:
    """Return a width, which is NaN in a record without a map.

    Raises:
        ValueError: it is negative or too large.
    """
    if math.isnan(value) or 0.0 <= value <= FARTHEST_M:
        return value
    raise ValueError("it must be 0 or more")


FARTHEST_M = 1e7  # of any place or size: beyond it single metres are lost in single precision
Number = Annotated[float, Field(allow_inf_nan=False, ge=-FARTHEST_M, le=FARTHEST_M)]
Length = Annotated[float, Field(allow_inf_nan=False, ge=0.0, le=FARTHEST_M)]
Width = Annotated[float, AfterValidator(_width)]
Name = Annotated[str, Field(max_length=1000)]
Whole = Annotated[int, Field(ge=-(2**31), lt=2**32)]
Key = Annotated[str, Field(pattern=r"^\d{1,10}$")]
Kind = Literal["stop_sign", "yield_sign", "traffic_light"]


class _Part(BaseModel):
    """An object of the document; fields of other versions are left to their reader."""

    model_config = ConfigDict(strict=True, frozen=True, extra="allow")


class _Vehicle(_Part):
    type_id: Name
    front_m: Length
    rear_m: Length
    width_m: Length


class _Place(_Part):
    s_m: Number
    x_m: Number
    y_m: Number
    z_m: Number
    yaw_rad: Number


class _Stop(_Place):
    id: Name
    name: Name


class _Control(_Place):
    kind: Kind
    landmark_id: Name


class _Route(_Part):
    id: Name
    town: Name
    points_m: Annotated[
        list[Annotated[list[Number], Field(min_length=3, max_length=3)]], Field(min_length=LEAST_POINTS)
    ]
    s_m: list[Number]
    yaw_rad: list[Number]
    lane_width_m: list[Width]
    speed_limit_mps: list[Length | None]
    is_junction: list[bool]
    road_id: list[Whole]
    lane_id: list[Whole]
    stops: list[_Stop]
    controls: list[_Control]

    @model_validator(mode="after")
    def _is_one_path(self) -> _Route:
        """Check that all arrays have one length and that the arc length grows."""
        number = len(self.points_m)
        for name in ("s_m", "yaw_rad", "lane_width_m", "speed_limit_mps", "is_junction", "road_id", "lane_id"):
            if len(getattr(self, name)) != number:
                raise ValueError(f"{name} has {len(getattr(self, name))} values for {number} points")
        if any(after <= before for before, after in pairwise(self.s_m)):
            raise ValueError("s_m does not grow from point to point")
        return self


class FactsDocument(_Part):
    """The content of ``route.json`` but for its version, which its reader checks first."""

    step_s: Annotated[float, Field(gt=0.0, le=1.0)]
    vehicle: _Vehicle
    actor_types: dict[Key, Name]
    actor_sizes: dict[Key, Annotated[list[Length], Field(min_length=2, max_length=2)]]
    route: _Route


def check_facts(document: dict[str, Any]) -> None:
    """Check the facts of a record.

    Raises:
        ValueError: a value is missing or cannot be used; the text names its place.
    """
    try:
        FactsDocument.model_validate(document)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(str(part) for part in first["loc"]) or "the document"
        what = "is missing" if first["type"] == "missing" else f"is refused: {first['msg']}"
        raise ValueError(f"{where} {what}") from None
