"""`joined`: joins ROS 2's DDS domain; domain and settings come from the variables of ROS and Cyclone DDS."""

from __future__ import annotations

import os
from typing import Any

from cyclonedds.core import DDSException
from cyclonedds.domain import Domain, DomainParticipant

DOMAINS = 232  # the highest domain: its ports still lie below 65536 (DDSI-RTPS 2.3, 9.6.1.1)
FAST_DDS = "<Compatibility><IgnoreTypeInformation>1.15</IgnoreTypeInformation></Compatibility>"
"""Fast DDS (vendor 1.15) says of strings, sequences and arrays what Cyclone DDS takes for no valid type, and then the
two are not joined. So they are joined by the type's name, and `dds_peers` compares the type hashes of ROS 2."""
ANY_NETWORK = f"<CycloneDDS><Domain>{FAST_DDS}</Domain></CycloneDDS>"
"""The settings of Cyclone DDS on all networks."""
ONLY_HERE = f"""<CycloneDDS><Domain><General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces>
<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>
<MaxAutoParticipantIndex>60</MaxAutoParticipantIndex><Peers><Peer address="127.0.0.1" PruneDelay="inf"/></Peers>
<SPDPInterval>1s</SPDPInterval></Discovery>
{FAST_DDS}</Domain></CycloneDDS>"""
"""The settings of Cyclone DDS for this machine alone: the loopback interface, without multicast.

A node of Fast DDS that comes later does not call us there, so we call each second, and without an end."""

_domains: dict[int, Any] = {}


class DdsError(Exception):
    """A domain cannot be joined; a sentence that says why, and what to do."""


def domain_of_environment() -> int:
    """Return the domain that ``ROS_DOMAIN_ID`` names, 0 without it.

    Raises:
        DdsError: it names none.
    """
    text = os.environ.get("ROS_DOMAIN_ID", "").strip() or "0"
    if not text.isdecimal() or int(text) > DOMAINS:
        raise DdsError(f"ROS_DOMAIN_ID is '{text}'; it must be a number from 0 to {DOMAINS}")
    return int(text)


def is_local() -> bool:
    """Return whether ROS stays on this machine, as it does unless a variable says otherwise.

    ``ROS_LOCALHOST_ONLY=0``, another ``ROS_AUTOMATIC_DISCOVERY_RANGE`` than ``LOCALHOST``, or settings of Cyclone DDS's
    own open other networks.
    """
    only, reach = (os.environ.get(name, "").strip() for name in ("ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE"))
    if only:
        return only != "0"
    if reach:
        return reach.upper() == "LOCALHOST"
    return not os.environ.get("CYCLONEDDS_URI", "").strip()


def joined(domain: int) -> Any:  # noqa: ANN401 - of cyclonedds
    """Return a new participant of a domain. The first one of the process brings the domain's settings.

    Raises:
        DdsError: DDS finds no network.
    """
    try:
        if domain not in _domains:
            _domains[domain] = _configured(domain)
        return DomainParticipant(domain)
    except DDSException as error:
        raise DdsError(
            f"DDS cannot join the domain {domain}: {error}; see ROS_DOMAIN_ID, CYCLONEDDS_URI and whether "
            "this machine has a network, or set ROS_LOCALHOST_ONLY=1"
        ) from error


def _configured(domain: int) -> Any:  # noqa: ANN401 - of cyclonedds
    """The domain with our settings, and the user's after them; None where other code of this process made it before."""
    users = os.environ.get("CYCLONEDDS_URI", "").strip()
    settings = ONLY_HERE if is_local() else f"{ANY_NETWORK},{users}".rstrip(",")
    try:
        return Domain(domain, settings)
    except DDSException as error:
        if error.code == DDSException.DDS_RETCODE_PRECONDITION_NOT_MET:
            return None
        raise
