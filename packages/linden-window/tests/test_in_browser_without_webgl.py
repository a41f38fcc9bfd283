"""Claim about the page in a browser without WebGL."""

from browsers import running_browser
from linden_window.link import PageLink
from window_pages import begin, drive, page_of

NO_WEBGL = ("--disable-gpu", "--disable-3d-apis")


def test_without_webgl_there_is_a_map_and_a_sentence(link: PageLink) -> None:
    begin(link)
    with running_browser(*NO_WEBGL) as browser:
        page = page_of(browser, link.address)
        page.wait_for_function("globalThis.page?.map.edges")
        drive(link, page, 3)
        assert "has no WebGL" in page.inner_text("#says")
        assert page.is_visible("#map")
        assert not page.is_visible("#picture")
        page.wait_for_function("page.poses.length === 1")
        assert page.errors == []
