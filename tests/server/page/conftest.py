"""One daemon and one browser for the tests of a file."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect, sync_playwright

from .browsing import CHROMIUM, CHROMIUM_ARGS, Daemon, theta_box

NETWORK_COMPLAINTS = ("Failed to load resource", "WebSocket connection to")
"""Chromium's own, of an answer that says no and of a daemon that is not there."""


@pytest.fixture(scope="module")
def daemon(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Daemon]:
    daemon = Daemon("--camera", "typical", "--fps", "30", folder=tmp_path_factory.mktemp("daemon"))
    yield daemon
    daemon.kill()


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    expect.set_options(timeout=15_000)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=CHROMIUM_ARGS)
        yield browser
        browser.close()


@pytest.fixture
def page(browser: Browser, daemon: Daemon) -> Iterator[Page]:
    """The page with the daemon's parameters on it; at the end it must not have complained on the console."""
    complaints: list[str] = []
    page = browser.new_page(viewport={"width": 1360, "height": 860})
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda message: complaints.append(message.text) if message.type == "error" else None)
    page.goto(daemon.url)
    expect(theta_box(page)).not_to_have_value("")
    yield page
    page.close()
    assert [text for text in complaints if not text.startswith(NETWORK_COMPLAINTS)] == []
