"""Tokens from a file and the environment."""

from pathlib import Path

import pytest

from voltcam_server.access import Tokens
from voltcam_server.problems import UsageError

VIEW, CONTROL = "v" * 20, "c" * 20


def token_file(folder: Path, text: str, mode: int = 0o600) -> Path:
    file = folder / "tokens"
    file.write_text(text)
    file.chmod(mode)
    return file


def test_roles(tmp_path: Path) -> None:
    file = token_file(tmp_path, f"# for the lab\nview {VIEW}\n\ncontrol {CONTROL}\n")
    tokens = Tokens.load(file, {"VOLTCAM_TOKEN": "e" * 16, "VOLTCAM_VIEW_TOKEN": ""})
    assert [tokens.role_of(token) for token in (VIEW, CONTROL, "e" * 16, "", "v" * 19, "é")] == [
        "view", "control", "control", None, None, None,
    ]  # fmt: skip
    assert not Tokens.load(None, {})


@pytest.mark.parametrize(
    ("text", "mode", "words"),
    [
        (f"control {CONTROL}", 0o640, "chmod 600"),
        ("", 0o600, "no token"),
        (f"admin {CONTROL}", 0o600, "line 1"),
        ("control short", 0o600, "16 characters"),
    ],
)
def test_files_that_will_not_do(text: str, mode: int, words: str, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=words) as refusal:
        Tokens.load(token_file(tmp_path, text, mode), {})
    assert "\n" not in str(refusal.value)
    assert CONTROL not in str(refusal.value)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="tokens_file"):
        Tokens.load(tmp_path / "none", {})
