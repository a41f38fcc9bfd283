"""One vehicle: tyres, powertrain, the motion in the plane of the road, and how it stands on that road."""
