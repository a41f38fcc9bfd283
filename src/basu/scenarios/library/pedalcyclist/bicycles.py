"""The bicycles that scenarios bring, and the room that they are owed."""

from __future__ import annotations

BICYCLE = "vehicle.diamondback.century"
HALF_WIDTH_M = 0.3
PASSING_M = 0.9  # three feet, to be kept by who overtakes a bicycle: Ohio Revised Code 4511.27 (A)(1)
SWAY_M = 0.5  # what is left to a cyclist who crosses: nearer is luck
EASY_MPS2 = 1.5  # how one gets going on a bicycle
