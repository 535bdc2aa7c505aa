"""The section `access` of the settings."""

from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field


class AccessSettings(BaseModel):
    """Who may use the daemon over the network, and what may be named over REST."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    hosts: list[str] = Field(
        default=[],
        description="names under which browsers may reach the daemon, such as robot.local; addresses of "
        "numbers and localhost are always allowed",
    )
    open: bool = Field(
        default=False,
        description="true: addresses beyond this machine need neither token nor keys, since something else "
        "keeps strangers out, such as a container whose ports are published to one machine",
    )
    tokens_file: Path | None = Field(
        default=None,
        description="a file with lines `view TOKEN` and `control TOKEN`, readable by its owner only; tokens "
        "may also be in the environment, VOLTCAM_VIEW_TOKEN and VOLTCAM_TOKEN",
    )
    tls_certificate: Path | None = Field(default=None, description="certificate chain in PEM, for https")
    tls_key: Path | None = Field(default=None, description="the certificate's private key in PEM")
    curve_keys: Path | None = Field(
        default=None,
        description="a folder made by `voltcam keys`: ZeroMQ is encrypted, and open to the keys in it only",
    )
    source_folders: list[Path] = Field(
        default=[Path()], description="recordings named over REST must lie in one of these folders"
    )
    source_devices: list[str] = Field(
        default=["/dev/video*"], description="patterns of the devices that may be named over REST"
    )
    source_urls: list[str] = Field(
        default=[], description="patterns of the videos that may be named over REST: rtsp://camera.local/*"
    )
    streams: list[str] = Field(
        default=["tcp://127.0.0.1:*", "tcp://localhost:*", "ipc://*"],
        description="patterns of the ZeroMQ addresses of cameras that a diagnosis may listen to",
    )
