"""Tokens: which there are, and what they allow."""

import hmac
import os
import stat
from collections.abc import Mapping
from pathlib import Path
from typing import Literal

from ..problems import UsageError

Role = Literal["view", "control"]
ROLES: dict[str, Role] = {"view": "view", "control": "control"}
SHORTEST_TOKEN = 16
FROM_ENVIRONMENT: dict[str, Role] = {"VOLTCAM_VIEW_TOKEN": "view", "VOLTCAM_TOKEN": "control"}


class Tokens:
    """The tokens of a daemon; without any, everyone who reaches it has control."""

    def __init__(self, tokens: list[tuple[Role, str]]) -> None:
        self._tokens: list[tuple[Role, bytes]] = [(role, token.encode()) for role, token in tokens]

    def __bool__(self) -> bool:
        return bool(self._tokens)

    def role_of(self, token: str) -> Role | None:
        """What a token allows. All are compared in constant time, so that an answer's time tells nothing."""
        found: Role | None = None
        for role, known in self._tokens:
            if hmac.compare_digest(token.encode(), known) and found != "control":
                found = role
        return found

    @classmethod
    def load(cls, file: Path | None, environment: Mapping[str, str] = os.environ) -> "Tokens":
        """From the file and the environment. Raises UsageError."""
        tokens: list[tuple[Role, str]] = [
            (role, environment[name]) for name, role in FROM_ENVIRONMENT.items() if environment.get(name)
        ]
        if file is not None:
            tokens += _of_file(file)
            if not tokens:
                raise UsageError(f"{file} holds no token: give lines such as `control TOKEN`")
        if any(len(token) < SHORTEST_TOKEN for _, token in tokens):
            raise UsageError(
                f"a token has fewer than {SHORTEST_TOKEN} characters: make one with `openssl rand -hex 32`"
            )
        return cls(tokens)


def _of_file(file: Path) -> list[tuple[Role, str]]:
    try:
        mode, text = file.stat().st_mode, file.read_text()
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is no text"
        raise UsageError(f"{file} cannot be read: {reason}: check access.tokens_file") from None
    if mode & (stat.S_IRGRP | stat.S_IROTH):
        raise UsageError(f"{file} can be read by others than its owner: chmod 600 {file}")
    tokens: list[tuple[Role, str]] = []
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        if len(words) != 2 or words[0] not in ROLES:
            raise UsageError(f"{file}, line {number}: give `view TOKEN` or `control TOKEN`")
        tokens.append((ROLES[words[0]], words[1]))
    return tokens
