"""Cookies in use: what they allow, for how long, and how many there may be."""

import time

import pytest

from voltcam_server.access.session import MOST_SESSIONS, SESSION_S, Sessions


def test_a_cookie_allows_what_it_was_begun_with_until_its_end() -> None:
    sessions = Sessions()
    control, view = sessions.begin("control"), sessions.begin("view")
    assert control != view
    assert (sessions.role_of(control), sessions.role_of(view)) == ("control", "view")
    sessions.end(control)
    sessions.end("never begun")
    assert (sessions.role_of(control), sessions.role_of(view)) == (None, "view")
    assert sessions.role_of("") is None


def test_it_is_over_after_half_a_day(monkeypatch: pytest.MonkeyPatch) -> None:
    sessions, now_s = Sessions(), time.monotonic()
    cookie = sessions.begin("view")
    monkeypatch.setattr(time, "monotonic", lambda: now_s + SESSION_S - 1)
    assert sessions.role_of(cookie) == "view"
    monkeypatch.setattr(time, "monotonic", lambda: now_s + SESSION_S + 60)
    assert sessions.role_of(cookie) is None


def test_the_oldest_ends_for_one_too_many() -> None:
    sessions = Sessions()
    first, *others = [sessions.begin("view") for _ in range(MOST_SESSIONS + 1)]
    assert sessions.role_of(first) is None
    assert all(sessions.role_of(cookie) == "view" for cookie in others)
