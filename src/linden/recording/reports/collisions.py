"""``show_recorder_collisions``: who ran into whom, and when it began. Source: ``CarlaRecorderQuery.cpp``."""

from linden.recording.layouts import SCENERY, ActorKind
from linden.recording.read import Recording
from linden.recording.reports.wording import ending, heading, number

ANY, HERO, OTHER = "a", "h", "o"
ASKED_FOR = {
    "h": "hero",
    "v": "vehicles",
    "w": "walkers",
    "t": "traffic lights and signs",
    "o": "others",
    "a": "any",
}
"""Kinds of actors that can be asked for."""
LETTERS: dict[int, str] = {
    ActorKind.OTHER: OTHER,
    ActorKind.VEHICLE: "v",
    ActorKind.WALKER: "w",
    ActorKind.TRAFFIC_LIGHT: "t",
    ActorKind.TRAFFIC_SIGN: "t",
    ActorKind.SENSOR: OTHER,
}
"""How the report calls a kind of actor; CARLA's own table has none for signs and sensors and shows what lies behind."""


def collisions(recording: Recording, first_kind: str, second_kind: str) -> str:
    """Return the report of contacts between actors of two kinds: letters of ``ASKED_FOR``.

    A contact that lasts is told once. Where one was told, the duration at the end has no decimals: CARLA's stream
    still rounds as for the times.
    """
    told = [heading(recording.header)]
    told.append(f"{'Time':>8} {'Types':>6} {'Id':>6} {'Actor 1':<35} {'Id':>6} {'Actor 2':<35}\n")
    letters, type_ids = {SCENERY: OTHER}, {SCENERY: ""}
    rows, number_, elapsed_s = 0, 0, 0.0
    lasting: set[tuple[int, int]] = set()
    for frame in recording.whole_frames():
        number_, elapsed_s = frame.number, frame.elapsed_s
        for actor in frame.added:
            letters[actor.id] = LETTERS.get(actor.kind, OTHER)
            type_ids[actor.id] = actor.description.id
        now: set[tuple[int, int]] = set()
        for _, first, second, first_is_hero, second_is_hero in frame.collisions.tolist():
            kinds = letters.get(first, OTHER), letters.get(second, OTHER)
            if not (_fits(first_kind, kinds[0], first_is_hero) and _fits(second_kind, kinds[1], second_is_hero)):
                continue
            now.add((first, second))
            if (first, second) not in lasting:
                rows += 1
                told.append(
                    f"{elapsed_s:8.0f}   {kinds[0]} {kinds[1]}  {first:>6} {type_ids.get(first, ''):<35} "
                    f"{second:>6} {type_ids.get(second, ''):<35}\n"
                )
        lasting = now
    told.append(ending(number_, f"{elapsed_s:.0f}" if rows else number(elapsed_s)))
    return "".join(told)


def _fits(wanted: str, letter: str, is_hero: int) -> bool:
    return wanted in (ANY, letter) or (wanted == HERO and bool(is_hero))
