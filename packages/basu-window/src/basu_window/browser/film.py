"""A film of a recorded run: a browser without a screen shows each moment, and PyAV encodes the pictures."""

from __future__ import annotations

import io
import shutil
import sys
import time
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
from tqdm import tqdm

from basu.errors import UserError
from basu.extras import require
from basu_window.extras import PLAYWRIGHT, PYAV

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from playwright.sync_api import Page

    from linden_window.link import PageLink

PICTURES_PER_S = 10
SIZE_PX = 1280, 720
QUALITY = "28"
"""x264's constant rate factor: about 3 Mbit/s."""
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
SWITCHES = (
    # root has no sandbox; WebGL is computed by the processor where there is no graphics card
    "--no-sandbox", "--no-first-run", "--disable-background-networking", "--disable-component-update",
    "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
)  # fmt: skip
PATIENCE_S = 180.0
"""A film fails if nothing new was loaded or drawn for so long; a busy machine may take any time in all."""
_POLL_S = 0.5
_PROGRESS = """() => { const page = globalThis.page;
    return page ? [page.replay.isOn && (page.isFlat || page.world.total >= 0), `${page.connection.bytes}`]
        : [false, document.readyState]; }"""
_SHOW = """([t, dt, limit]) => new Promise((done, fail) => {
    let [before, since] = ["", performance.now()];
    const watch = setInterval(() => {
        const now = [page.world.loaded, page.actors.models.size, page.actors.isLoading, page.pictures].join();
        if (now !== before) [before, since] = [now, performance.now()];
        else if (performance.now() - since > limit) end(() => fail(new Error("no picture was drawn")));
    }, 500);
    const end = (act) => { clearInterval(watch); act(); };
    page.show(t, dt).then(() => end(done), (error) => end(() => fail(error))); })"""


def check_film(file: Path) -> None:
    """Check that a film can be made, before records are read.

    Raises:
        UserError: a package or a browser is missing, or the file cannot be written.
    """
    require(PLAYWRIGHT)
    require(PYAV)
    browser_path()
    if file.suffix != ".mp4":
        raise UserError(f"--film {file}: a film is an MP4 file; name it {file.with_suffix('.mp4')}")
    if not file.resolve().parent.is_dir():
        raise UserError(f"--film {file}: there is no folder {file.parent}; make it, or name another")


def write_film(link: PageLink, file: Path, from_s: float, until_s: float) -> None:
    """Write the film of a record in the page, ten pictures for each simulated second.

    Args:
        link: of the page with the record; what it has not yet sent is sent meanwhile.
        file: MP4 file with H.264.
        from_s: simulated time of the first picture.
        until_s: simulated time of the last picture.

    Raises:
        UserError: the times contradict each other, or the page does not show the record.
    """
    if not 0.0 <= from_s < until_s:
        raise UserError(f"the film would begin at {from_s:g} s and end at {until_s:g} s; name an earlier --film-from")
    times_s = np.arange(from_s, until_s + 1e-6, 1.0 / PICTURES_PER_S)
    pictures = _pictures(link, times_s.tolist())
    often_s = 0.1 if sys.stderr.isatty() else 10.0
    _encode(file, tqdm(pictures, total=len(times_s), unit=" pictures", desc="filming", mininterval=often_s))


def _pictures(link: PageLink, times_s: list[float]) -> Iterator[bytes]:
    """Yield the page at each moment as a JPEG file."""
    from playwright.sync_api import Error, sync_playwright  # noqa: PLC0415 - an extra

    width, height = SIZE_PX
    patience_ms = 1000.0 * PATIENCE_S
    try:
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(
                executable_path=browser_path(), args=list(SWITCHES), timeout=patience_ms
            )
            page = browser.new_page(viewport={"width": width, "height": height}, bypass_csp=True)
            page.set_default_timeout(patience_ms)
            page.goto(f"{link.address}?view=chase&film", wait_until="commit")
            _wait_until_loaded(page, link)
            for t_s in times_s:
                page.evaluate(_SHOW, [t_s, 1.0 / PICTURES_PER_S, patience_ms])
                yield page.screenshot(type="jpeg", quality=92)
            browser.close()
    except Error as error:
        raise UserError(
            f"the film is not complete: {error.message.splitlines()[0]}. The browser showed nothing new for "
            f"{PATIENCE_S:.0f} s, or has ended; try again, with fewer other programs or a part of the run "
            "(--film-from, --film-to)"
        ) from error


def _wait_until_loaded(page: Page, link: PageLink) -> None:
    """Wait until the page has the record and knows the parts of the scenery.

    Raises:
        UserError: nothing new was loaded for ``PATIENCE_S``.
    """
    before, since_s = None, time.monotonic()
    while True:
        link.flush()
        is_done, progress = page.evaluate(_PROGRESS)
        if is_done:
            return
        if progress != before:
            before, since_s = progress, time.monotonic()
        elif time.monotonic() - since_s > PATIENCE_S:
            raise UserError(f"the page of the film loaded nothing new for {PATIENCE_S:.0f} s; try again")
        time.sleep(_POLL_S)


def _encode(file: Path, pictures: Iterable[bytes]) -> None:
    import av  # noqa: PLC0415 - an extra

    with av.open(str(file), "w") as film:
        stream: Any = film.add_stream("libx264", rate=Fraction(PICTURES_PER_S))
        stream.options = {"crf": QUALITY}
        stream.width, stream.height, stream.pix_fmt = *SIZE_PX, "yuv420p"
        for number, picture in enumerate(pictures):
            with av.open(io.BytesIO(picture), format="mjpeg") as still:
                frame = next(still.decode(video=0)).reformat(format="yuv420p")
            frame.pts, frame.time_base = number, Fraction(1, PICTURES_PER_S)
            film.mux(stream.encode(frame))
        film.mux(stream.encode(None))


def browser_path() -> str:
    """Return the path of a Chromium.

    Raises:
        UserError: there is none.
    """
    found = next((path for path in map(shutil.which, BROWSERS) if path), None)
    if found is None:
        raise UserError(f"--film needs a browser, and none of {', '.join(BROWSERS)} is installed; install Chromium")
    return found
