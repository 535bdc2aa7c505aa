"""Every block of every page is run, or says why not; every `voltcam` command in them can be given so."""

import contextlib
import importlib.util
import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from tests.docs.blocks import ROOT, Block, blocks, pages
from tests.docs.commands import commands, names, parse, parser_of
from tests.docs.things import images, make
from tests.server.process import Daemon

from voltcam_server.dataset.spec import spec_of
from voltcam_server.settings import Settings, load
from voltcam_simulator import Camera

LIMIT_S = 240
PAGES = pages()
LIVE = re.compile(
    r"(127\.0\.0\.1|localhost):([58]560|7777)|\"127\.0\.0\.1\", 7777|voltcam (listen|record|status|biases)"
)


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def runs(page: Path) -> list[Block]:
    return [block for block in blocks(page) if block.reason is None]


NOT_RUN = [(page, block) for page in PAGES for block in blocks(page) if block.reason is not None]


class Reader:
    """Someone who types a page's blocks in an empty folder, with a daemon beside where the page has one."""

    def __init__(self, folder: Path, daemon: Daemon | None) -> None:
        self.folder, self.daemon = folder, daemon
        frames = [(frame, 10_000 * i) for i, frame in enumerate(images(346, 260))]
        self.names: dict[str, Any] = {"__name__": "__main__", "frames": frames}
        self.environment = os.environ | {"PYTHONPATH": str(ROOT)}
        programs = folder / ".bin"
        programs.mkdir()
        (programs / "voltcam").write_text(f'#!/bin/sh\nexec "{sys.executable}" -m tests.docs.voltcam "$@"\n')
        (programs / "voltcam").chmod(0o755)
        python = Path(sys.executable).parent
        self.environment["PATH"] = os.pathsep.join([str(programs), str(python), os.environ["PATH"]])
        if daemon is not None:
            self.environment |= {"PAGES_ZMQ": daemon.zmq, "PAGES_HTTP": daemon.url.rstrip("/")}

    def here(self, text: str) -> str:
        """With the addresses of the daemon that is there."""
        text = text.replace(".venv/bin/", "")
        if self.daemon is None:
            return text
        for port, address in (("5560", self.daemon.zmq), ("8560", self.daemon.url)):
            place = address.split("//")[1].rstrip("/")
            text = re.sub(rf"(127\.0\.0\.1|localhost):{port}", place, text)
        return re.sub(r"\b7777\b", str(self.daemon.get("camera")["dv"]).rpartition(":")[2], text)

    def run(self, block: Block, page: Path) -> None:
        for thing in block.given:
            assert (self.folder / thing).exists() or make(self.folder / thing), f"{thing} cannot be made"
        getattr(self, f"_{block.language}")(block, page)

    def _python(self, block: Block, page: Path) -> None:
        lines = "\n" * (block.line - 1) + self.here(block.text)  # so that tracebacks name lines of the page
        exec(compile(lines, str(page), "exec"), self.names)

    def _sh(self, block: Block, page: Path) -> None:
        answer = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", self.here(block.text)],
            cwd=self.folder,
            env=self.environment,
            capture_output=True,
            text=True,
            check=False,
            timeout=LIMIT_S,
        )
        words = f"{name_of(page)}, line {block.line}: {answer.stdout[-2000:]}{answer.stderr[-2000:]}"
        assert answer.returncode == 0, words

    def _yaml(self, block: Block, page: Path) -> None:
        """A spec of a data set, a config file or a camera file."""
        content = yaml.safe_load(block.text)
        if "inputs" in content:
            spec_of(content, str(page))
            return
        if set(content) <= set(Settings.model_fields):
            load(content, environment={})
        else:
            Camera.from_mapping(content)

    def _json(self, block: Block, page: Path) -> None:
        json.loads(block.text)


@contextlib.contextmanager
def at_most(seconds: int) -> Iterator[None]:
    def late(*_: object) -> None:
        raise TimeoutError(f"not within {seconds} s")

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


@contextlib.contextmanager
def daemon_of(page: Path, folder: Path) -> Iterator[Daemon | None]:
    """A daemon, where a block that is run speaks of one."""
    if not any(LIVE.search(block.text) for block in runs(page)):
        yield None
        return
    config = folder / "daemon.yaml"
    config.write_text(
        yaml.safe_dump({"recordings": str(folder), "access": {"source_folders": [str(folder)]}})
    )
    with Daemon("--config", str(config), "--fps", "30") as daemon:
        yield daemon


@pytest.mark.parametrize("page", [page for page in PAGES if runs(page)], ids=name_of)
def test_the_blocks_of_a_page_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with daemon_of(page, tmp_path) as daemon, at_most(LIMIT_S):
        reader = Reader(tmp_path, daemon)
        missing = set()
        for block in runs(page):
            lacks = {name for name in block.needs if importlib.util.find_spec(name) is None}
            missing |= lacks
            if not lacks:
                reader.run(block, page)
    if missing:
        pytest.skip(f"blocks that need {', '.join(sorted(missing))} were not run")


@pytest.mark.parametrize(
    ("page", "block"),
    NOT_RUN,
    ids=[f"{name_of(page)}:{block.line}: {block.reason}" for page, block in NOT_RUN],
)
def test_what_is_not_run_could_be_typed(page: Path, block: Block) -> None:
    """It says why it is not run; its commands have these arguments; its Python is Python."""
    assert block.reason
    if block.language == "python":
        compile(block.text, str(page), "exec")
    if block.language == "sh":
        for arguments in commands(block.text):
            parse(arguments)


def test_the_examples_of_each_command_can_be_typed() -> None:
    examples = [
        arguments
        for command in names()
        for line in (parser_of(command).epilog or "").splitlines()
        if line.startswith("  voltcam ")
        for arguments in commands(re.sub(r"\s{3,}.*", "", line.strip()))
    ]
    assert len(examples) > 20
    for arguments in examples:
        parse(arguments)
