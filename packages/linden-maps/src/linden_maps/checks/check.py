"""``check`` runs all checks on an OpenDRIVE map in a fixed order and returns the findings."""

from linden.maps.opendrive.model import OpenDrive
from linden_maps.checks.finding import Finding, Severity
from linden_maps.checks.joints import lane_joints, road_joints
from linden_maps.checks.lane_links import junctions, lane_ends, lane_links_returned, road_links
from linden_maps.checks.missing_facts import georeference, lane_changes, speed_limits
from linden_maps.checks.overlaps import overlaps, raised_ground
from linden_maps.checks.shape import grades, lane_widths, profiles, reference_lines
from linden_maps.checks.signals import controllers, objects, signals

__all__ = ["Finding", "Severity", "check"]

_CHECKS = (
    georeference,
    speed_limits,
    lane_changes,
    reference_lines,
    profiles,
    grades,
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
