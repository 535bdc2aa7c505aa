"""ROS 2 without ROS: its messages in CDR, and its topics through Eclipse Cyclone DDS (the extra `ros2`)."""

from voltcam_client.errors import VoltcamError


class Ros2Error(VoltcamError):
    """A name, a setting or a network that ROS 2's topics cannot be had with."""
