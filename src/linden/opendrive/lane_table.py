"""The table that says what each lane of a road mesh is: its columns, so that who only reads it needs no mesh."""

import numpy as np

LANES = np.dtype(
    [
        ("road_id", "i4"),
        ("section", "i4"),
        ("lane_id", "i4"),
        ("junction", "i4"),  # -1 outside of junctions
        ("type_bits", "u4"),  # values.enums.LaneType
        ("speed_limit_mps", "f8"),  # nan where the map says nothing
        ("tag", "u1"),  # values.enums.SemanticTag
    ]
)
