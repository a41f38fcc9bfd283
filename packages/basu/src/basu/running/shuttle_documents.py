"""``shuttles.json`` of a run with several vehicles under test: each with its result, and the contacts between them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu.metrics.shuttle_contacts import Recorded, contacts_between
from basu.output.report.documents import write_json
from basu.output.report.shuttles import SHUTTLES_FILE, SHUTTLES_SCHEMA_VERSION

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from basu.episode import VehicleUnderTest
    from basu.metrics.result import Result
    from basu.metrics.shuttle_contacts import ShuttleContact
    from basu.running.shuttles import Shuttle


def known_as(vehicles: Sequence[VehicleUnderTest]) -> list[dict[int, int]]:
    """Return, for each vehicle, the numbers that its record gives to the others, by their places in the run."""
    return [
        {
            place: vehicle.run.numbering.of(other.run.vehicle.id)
            for place, other in enumerate(vehicles)
            if other is not vehicle
        }
        for vehicle in vehicles
    ]


def shuttle_facts(shuttle: Shuttle, shuttles: Sequence[Shuttle]) -> dict[str, Any] | None:
    """Return what ``config.json`` says of one vehicle among several; None where it is the only one."""
    if len(shuttles) == 1:
        return None
    return {
        "number": shuttle.number,
        "of": len(shuttles),
        "role": shuttle.role,
        "start_m": shuttle.start_m,
        "agents": [each.loaded.name for each in shuttles],
    }


def write_shuttles(
    folder: Path, shuttles: Sequence[Shuttle], results: Sequence[Result], numbers: Sequence[Mapping[int, int]]
) -> None:
    """Write the document of all vehicles into the folder of a run.

    ``numbers`` are those of the other vehicles in each record, see `known_as`.

    Raises:
        UserError: the disk is full or the folder cannot be written.
    """
    records = [Recorded(result.history, others) for result, others in zip(results, numbers, strict=True)]
    contacts = contacts_between(records)
    write_json(
        folder / SHUTTLES_FILE,
        {
            "schema_version": SHUTTLES_SCHEMA_VERSION,
            "shuttles": [
                _shuttle(shuttle, result, others)
                for shuttle, result, others in zip(shuttles, results, numbers, strict=True)
            ],
            "contacts": [_contact(contact, records) for contact in contacts],
        },
    )


def _shuttle(shuttle: Shuttle, result: Result, others: Mapping[int, int]) -> dict[str, Any]:
    """Return one vehicle with its result in short."""
    return {
        "number": shuttle.number,
        "role": shuttle.role,
        "agent": shuttle.loaded.name,
        "folder": shuttle.folder or ".",
        "start_m": shuttle.start_m,
        "status": result.outcome.status.value,
        "fault": result.outcome.status.fault.name.lower(),
        "message": result.outcome.message,
        "passed": result.success.passed,
        "scores": None if result.scores is None else result.scores._asdict(),
        "others": {str(place + 1): number for place, number in others.items()},  # in its record, by their numbers here
    }


def _contact(contact: ShuttleContact, records: Sequence[Recorded]) -> dict[str, Any]:
    """Return a contact with the judgement for each vehicle."""
    step_s = next(record.history.facts.step_s for record in records if record.history is not None)
    return {
        "tick": contact.tick,
        "t_s": round(contact.tick * step_s, 3),
        "between": [place + 1 for place in contact.pair],
        "at_fault": [None if blame is None else blame.at_fault for blame in contact.blames],
        "sentences": [None if blame is None else blame.sentence for blame in contact.blames],
    }
