"""`export`: replays a recorded run, observes its frames, and writes them in a format."""

from __future__ import annotations

import shutil
from contextlib import ExitStack
from typing import TYPE_CHECKING, NamedTuple, Protocol

from basu.errors import UserError
from basu_truth.alone import alone_world
from basu_truth.formats.coco import CocoWriter
from basu_truth.formats.kitti import KittiWriter
from basu_truth.formats.nuscenes import NuscenesWriter
from basu_truth.geometry import pose_of
from basu_truth.observing import Observer
from basu_truth.scene import replayed
from basu_truth.truth import Truth, TruthFrame, write_truth

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from basu_carla_log.server_replay import Where
    from basu_truth.recorded_run import RecordedRun
    from basu_truth.scene import Shot
    from basu_truth.truth import SeenObject, Sensor


class Writer(Protocol):
    """Writes an export in one format, frame by frame."""

    def write(self, shot: Shot, objects: Sequence[SeenObject]) -> None:
        """Write what the sensors measured in a frame."""

    def finish(self, truth: Truth) -> None:
        """Write what is written once all frames are known."""


class MakeWriter(Protocol):
    """Makes the writer of an export."""

    def __call__(self, folder: Path, sensors: Sequence[Sensor]) -> Writer:
        """Return the writer into a folder that is there, for these sensors."""


WRITERS: dict[str, MakeWriter] = {
    "coco": CocoWriter,
    "kitti": KittiWriter,
    "nuscenes": NuscenesWriter,
}
"""The formats of exports."""


class Exported(NamedTuple):
    """A frame that is done, of so many of the recording."""

    frame: int
    of: int
    objects: int


def export(
    run: RecordedRun, folder: Path, make_writer: MakeWriter | None, where: Where, *, every: int
) -> Iterator[Exported]:
    """Write the truth of a run into a new folder; yield after each frame.

    Args:
        run: the recorded run.
        folder: that is written; it must not exist.
        make_writer: makes the writer of the format; None: only the truth, without pictures and clouds.
        where: the simulator that replays the run.
        every: each so manyth frame of the recording is written.

    Raises:
        UserError: the folder is there, or the run cannot be replayed.
        SimulatorError: a simulator went away.
    """
    if folder.exists():
        raise UserError(f"{folder} is there already; name another folder with -o, or remove it")
    draft = folder.with_name(f".{folder.name}.part")
    shutil.rmtree(draft, ignore_errors=True)
    try:
        draft.mkdir(parents=True)
    except OSError as error:
        raise UserError(f"{draft} could not be made: {error.strerror}; name another folder with -o") from error
    try:
        yield from _written(run, draft, make_writer, where, every=every)
        draft.rename(folder)
    except BaseException:
        shutil.rmtree(draft, ignore_errors=True)
        raise


def _written(
    run: RecordedRun, draft: Path, make_writer: MakeWriter | None, where: Where, *, every: int
) -> Iterator[Exported]:
    """Write the export into a folder that is there."""
    frames: list[TruthFrame] = []
    objects: list[SeenObject] = []
    with ExitStack() as stack:
        scene = stack.enter_context(replayed(run, where, every=every, pictures=make_writer is not None))
        bare = stack.enter_context(alone_world(run.town, scene.declared, run.step_s, where.timeout_s))
        sensors = tuple(each.sensor for each in scene.declared)
        writer = None if make_writer is None else make_writer(draft, sensors)
        observer = Observer(scene, bare)
        for shot in scene.shots():
            seen = observer.observed(shot)
            frames.append(
                TruthFrame(number=shot.number, t_s=shot.t_s, ego=pose_of(shot.ego), weather=dict(shot.weather))
            )
            objects += seen
            if writer is not None:
                writer.write(shot, seen)
            yield Exported(shot.number, run.log.frames, len(seen))
    truth = Truth(
        run=run.name,
        town=run.town,
        step_s=run.step_s,
        every=every,
        sensors=sensors,
        frames=tuple(frames),
        objects=tuple(objects),
    )
    write_truth(draft, truth)
    if writer is not None:
        writer.finish(truth)
