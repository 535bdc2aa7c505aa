"""The steps of a long command, on a terminal and where output goes to a file."""

import sys
from io import StringIO

import pytest

from voltcam_lab.steps import told_steps


class Terminal(StringIO):
    def isatty(self) -> bool:
        return True


def test_a_file_gets_a_line_for_each_step_as_it_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stderr", file := StringIO())
    with told_steps("{desc}", 2) as step:
        step("reading")
        assert file.getvalue() == "voltcam: 0 s: reading\n"
        step("fitting")
        step("fitting")
    _, second = file.getvalue().splitlines()
    assert second.endswith(" s: fitting")


def test_a_terminal_gets_a_bar_that_goes_at_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stderr", terminal := Terminal())
    with told_steps("{desc} {n_fmt}/{total_fmt}", 2) as step:
        step("reading")
        step("fitting")
    shown = terminal.getvalue()
    assert "fitting 1/2" in shown
    assert "\n" not in shown
    assert not shown.rstrip("\r").rpartition("\r")[2].strip()  # blanks over the bar
