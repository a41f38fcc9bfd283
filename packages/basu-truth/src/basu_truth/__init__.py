"""Ground truth of recorded runs: what each camera and lidar could see, in public formats, and scores of detectors.

``basu truth export`` replays a recorded run and counts the pixels and the lidar points of each object.
``basu truth evaluate`` compares a detector's output with the result. Begin reading at :mod:`basu_truth.observing`.
"""
