"""The tutorial, and the script of it: one text, and the figures that the page shows."""

import re
import subprocess
import sys

import numpy as np
from tests.docs.blocks import DOCS, blocks

PAGE, SCRIPT = DOCS / "start" / "test-your-algorithm.md", DOCS / "start" / "tracker.py"
LIVE = "voltcam_client"


def test_the_page_shows_the_script() -> None:
    shown = [block.text for block in blocks(PAGE) if block.language == "python"]
    live = next(i for i, text in enumerate(shown) if LIVE in text)
    lines = [line for text in shown[:live] for line in text.splitlines() if line]
    script = SCRIPT.read_text(encoding="utf-8").split('"""\n\n', 1)[1]
    assert lines == [line for line in script.splitlines() if line]


def test_the_figures_are_those_of_the_page() -> None:
    """To what a machine's last bit may change: 2 % of the events, 0.3 pixels."""
    answer = subprocess.run(
        [sys.executable, SCRIPT], capture_output=True, text=True, check=True, timeout=120
    ).stdout
    shown = "".join(re.findall(r"```text\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL))
    there, here = figures(shown), figures(answer)
    assert there.shape == here.shape == (12, 4)
    np.testing.assert_allclose(here[:, 1], there[:, 1], rtol=0.02)
    np.testing.assert_allclose(here[:, 2:], there[:, 2:], atol=0.3)


def figures(text: str) -> np.ndarray:
    """Temperature or threshold, events, error, error with the filter: the lines that begin with a number."""
    lines = re.findall(r"^ +([\d.]+)(?: C)? +(\d+) +([\d.]+) +([\d.]+)$", text, re.MULTILINE)
    return np.array(lines, float)
