"""A page followed to the letter: its files, its lines put into other files, its commands, on a copy of all.

A fenced block is a step when the paragraph above it ends in one of these ways:

    `path`                            a new file
    In `path`, before `line`:         lines to be put there, where exactly one line begins so
    In `path`, after `line`:

A path is relative to the root of the repository; one without a folder is a file in the working folder. Blocks
of `sh` are commands. Anything else is there to be read.
"""

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
CODE = ("client", "simulator", "server")
COPIED = ("tests", "docs", "pyproject.toml")
LIMIT_S = 300

_BLOCK = re.compile(r"(?P<above>[^\n]*)\n\n```(?P<language>\w+)\n(?P<content>.*?)```", re.DOTALL)
_FILE = re.compile(r"`([\w./-]+)`:?$")
_LINE = re.compile(r"[Ii]n `([\w./-]+)`,\s+(before|after)\s+`([^`]+)`:$")


@dataclass(frozen=True)
class Followed:
    """A copy of the repository with a page followed. commands: the page's blocks of `sh`, not yet run."""

    root: Path
    commands: list[str]

    @property
    def environment(self) -> dict[str, str]:
        """In which the copy's packages come before the installed ones."""
        paths = os.pathsep.join(str(self.root / folder) for folder in CODE)
        scripts = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
        own = {"PYTHONPATH": paths, "PATH": scripts}
        if (self.root / "simulator").exists():  # its kernels, which nobody else will run
            own["XDG_CACHE_HOME"] = str(self.root / "cache")
        return os.environ | own

    def run(self, command: str) -> str:
        """What a command of the shell prints; it must succeed."""
        answer = subprocess.run(
            ["bash", "-euc", command],
            cwd=self.root,
            env=self.environment,
            capture_output=True,
            text=True,
            check=False,
            timeout=LIMIT_S,
        )
        assert answer.returncode == 0, f"{command}\n{answer.stdout}{answer.stderr}"
        return answer.stdout


def follow(page: str, root: Path) -> Followed:
    """Follow a page, named from `docs`, on a copy below `root`, up to its commands.

    Of the packages only those that the page touches are copied: kernels of the others are compiled already.
    """
    for name in COPIED:
        _copy(name, root)
    text, commands = (ROOT / "docs" / page).read_text(encoding="utf-8"), []
    for block in _BLOCK.finditer(text):
        above, content = block["above"].strip(), block["content"]
        if block["language"] == "sh":
            commands.append(content)
        elif line := _LINE.search(_paragraph(text, block.start("above"), block.end("above"))):
            _put(_place(line[1], root), line[2], line[3], content)
        elif new := _FILE.search(above):
            path = _place(new[1], root)
            assert not path.exists(), f"{page}: {new[1]} is there already"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(content, encoding="utf-8")
    return Followed(root, commands)


def _place(path: str, root: Path) -> Path:
    """Where a path of the page is in the copy, its package with it."""
    parts = Path(path).parts
    if parts[0] in CODE:
        _copy("/".join(parts[:2]), root)
    return root / path


def _copy(name: str, root: Path) -> None:
    source, target = ROOT / name, root / name
    if source.is_dir() and not target.exists():
        shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__", "_build"))
    elif source.is_file():
        shutil.copy(source, target)


def _paragraph(text: str, begin: int, end: int) -> str:
    """The paragraph that ends with a line, as one line."""
    return " ".join(text[text.rindex("\n\n", 0, begin) : end].split())


def _put(path: Path, side: str, beginning: str, lines: str) -> None:
    """Put lines before or after the one line that begins so, blanks aside."""
    before = path.read_text(encoding="utf-8").splitlines(keepends=True)
    found = [i for i, line in enumerate(before) if line.strip().startswith(beginning)]
    assert len(found) == 1, f"{path.name}: {len(found)} lines begin with {beginning!r}"
    place = found[0] + (side == "after")
    path.write_text("".join([*before[:place], lines, *before[place:]]), encoding="utf-8")
