import pytest
from pydantic import ValidationError

from voltcam_video import SourceRequest


def test_default_is_the_scene_in_real_time() -> None:
    request = SourceRequest()
    assert (request.uri, request.pace, request.loop, request.fit) == ("scene", "realtime", False, "crop")


def test_a_camera_index_may_be_a_number() -> None:
    assert SourceRequest.model_validate({"uri": 0}).uri == "0"


@pytest.mark.parametrize(
    "wrong",
    [
        {"url": "scene"},
        {"uri": ""},
        {"fps": 0},
        {"fps": float("nan")},
        {"width": -1},
        {"pixel_format": "MJPEG"},
        {"pace": "slow"},
        {"fit": "zoom"},
        {"timeout_s": 0},
    ],
)
def test_wrong_requests_are_refused(wrong: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        SourceRequest.model_validate(wrong)


def test_every_field_is_described_for_editors_and_the_page() -> None:
    assert all(field.description for field in SourceRequest.model_fields.values())


@pytest.mark.parametrize(
    ("uri", "shown"),
    [
        ("rtsp://admin:secret@10.0.0.7:554/live", "rtsp://admin:***@10.0.0.7:554/live"),
        ("rtsp://admin@10.0.0.7/live", "rtsp://admin@10.0.0.7/live"),
        ("rtsp://u:p@ss@h/live", "rtsp://u:***@h/live"),
        ("http://h/live?user=a&pwd=secret&fps=5", "http://h/live?user=a&pwd=***&fps=5"),
        ("http://10.0.0.7/a:b@c", "http://10.0.0.7/a:b@c"),
        ("clip.mp4", "clip.mp4"),
    ],
)
def test_passwords_are_not_shown(uri: str, shown: str) -> None:
    assert SourceRequest(uri=uri).shown == shown


@pytest.mark.parametrize("uri", ["ros1:/camera/image_raw", "ros1:camera"])
def test_a_topic_is_no_file(uri: str) -> None:
    request = SourceRequest(uri=uri)
    assert (request.ros1_topic, request.path, request.device) == (uri[5:], None, None)


def test_a_file_is_no_topic() -> None:
    assert SourceRequest(uri="camera.npz").ros1_topic is None
