"""What a careful reader finds wrong with a map, in a fixed order: its words, its shapes, its links, its signs."""

from linden.opendrive.checks.finding import Finding, Severity
from linden.opendrive.checks.furniture import controllers, objects, signals
from linden.opendrive.checks.joints import lane_joints, road_joints
from linden.opendrive.checks.links import junctions, lane_ends, lane_links_returned, road_links
from linden.opendrive.checks.overlaps import overlaps, raised_ground
from linden.opendrive.checks.shape import lane_widths, profiles, reference_lines
from linden.opendrive.checks.wording import georeference, lane_changes, speed_limits
from linden.opendrive.model import OpenDrive

__all__ = ["Finding", "Severity", "check"]

_CHECKS = (
    georeference,
    speed_limits,
    lane_changes,
    reference_lines,
    profiles,
    lane_widths,
    road_links,
    road_joints,
    lane_links_returned,
    lane_joints,
    lane_ends,
    junctions,
    signals,
    controllers,
    objects,
    overlaps,
    raised_ground,
)


def check(opendrive: OpenDrive) -> list[Finding]:
    """Return everything found; an empty list, or notes alone, mean that nothing is wrong."""
    return [finding for family in _CHECKS for finding in family(opendrive)]
