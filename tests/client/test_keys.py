"""Keys on disk: whose are where, who may read them, and what is said of those that are no keys."""

import stat
from pathlib import Path

import pytest
import zmq

from voltcam_client.errors import VoltcamError
from voltcam_client.keys import make_keys, pair, use_keys


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def test_each_client_has_a_pair_of_its_own_and_the_camera_knows_the_public_half(tmp_path: Path) -> None:
    folders = make_keys(tmp_path / "keys", ["robot", "desk"])
    assert [folder.name for folder in folders] == ["for-robot", "for-desk"]
    known = tmp_path / "keys" / "clients"
    assert sorted(path.name for path in known.iterdir()) == ["desk.key", "robot.key"]
    public = [
        pair(folder / f"{name}.key_secret")[0]
        for folder, name in zip(folders, ("robot", "desk"), strict=True)
    ]
    assert public[0] != public[1]
    assert public[0].decode() in (known / "robot.key").read_text()
    assert (
        pair(tmp_path / "keys" / "camera.key_secret")[0].decode() in (folders[0] / "camera.key").read_text()
    )


def test_secrets_are_their_owner_s_alone(tmp_path: Path) -> None:
    (folder,) = make_keys(tmp_path / "keys", ["robot"])
    assert mode(tmp_path / "keys" / "camera.key_secret") == 0o600
    assert mode(folder / "robot.key_secret") == 0o600
    assert mode(folder) == 0o700


def test_another_client_leaves_the_camera_s_pair_as_it_is(tmp_path: Path) -> None:
    make_keys(tmp_path, ["robot"])
    before = (tmp_path / "camera.key_secret").read_bytes()
    make_keys(tmp_path, ["desk"])
    assert (tmp_path / "camera.key_secret").read_bytes() == before


@pytest.mark.parametrize(
    ("name", "words"), [("robot", "has keys already"), ("camera", "no name"), ("../up", "no name")]
)
def test_names_that_cannot_be_are_refused(tmp_path: Path, name: str, words: str) -> None:
    make_keys(tmp_path, ["robot"])
    with pytest.raises(VoltcamError, match=words):
        make_keys(tmp_path, [name])


def test_a_socket_uses_a_client_s_folder_and_no_other(tmp_path: Path) -> None:
    (folder,) = make_keys(tmp_path, ["robot"])
    with zmq.Context() as context, context.socket(zmq.SUB) as socket:
        use_keys(socket, folder)
        assert socket.mechanism == zmq.CURVE
        with pytest.raises(VoltcamError, match="no client's folder"):
            use_keys(socket, tmp_path / "clients")


def test_what_is_no_pair_is_told_with_the_remedy(tmp_path: Path) -> None:
    make_keys(tmp_path, [])
    (tmp_path / "empty").write_text("")
    for file in ("none", "empty", "camera.key"):
        with pytest.raises(VoltcamError, match="`voltcam keys`"):
            pair(tmp_path / file)
