"""Names from the network, and what they may mean."""

from pathlib import Path

import pytest

from voltcam_server.access import AccessError, resolve_under


@pytest.mark.parametrize(
    "name",
    [
        "../out.npz",
        "/etc/passwd",
        "a/../../out.npz",
        "a\0.npz",
        "x" * 300 + ".npz",
        "link/out.npz",
        "~root/a",
    ],
)
def test_what_leads_outside_is_refused_in_one_line(name: str, tmp_path: Path) -> None:
    inside = tmp_path / "in"
    inside.mkdir()
    (inside / "link").symlink_to(tmp_path)
    if name == "~root/a":
        assert resolve_under([inside], name) == inside / name  # a name like another: no shell is asked
        return
    with pytest.raises(AccessError) as refusal:
        resolve_under([inside], name)
    assert "\n" not in str(refusal.value)
    assert len(str(refusal.value)) < 200


@pytest.mark.parametrize("name", ["a.npz", "deep/er/a.npz", "./a.npz", "deep/../a.npz"])
def test_what_is_below_is_allowed(name: str, tmp_path: Path) -> None:
    assert resolve_under([tmp_path], name) == (tmp_path / name).resolve()
    assert resolve_under([Path("/nowhere"), tmp_path], str(tmp_path / name)) == (tmp_path / name).resolve()
