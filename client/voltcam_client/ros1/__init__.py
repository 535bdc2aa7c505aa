"""ROS 1's own protocols: a node that publishes and subscribes beside any roscore, without a ROS installation.

rospy comes with one Python of one distribution, and no registry has it; Voltcam needs Python 3.11, and the
ROS 1 that most robots run (Noetic) has 3.8. What a node says is little: XML-RPC to the roscore and to other
nodes, and messages with their length over TCP.

Sources: wiki.ros.org/ROS/Master_API, Slave_API, TCPROS, Names, Technical Overview.
"""

from voltcam_client.errors import VoltcamError


class RosError(VoltcamError):
    """A roscore, a node or a topic that is not there, or does not say what ROS 1 says."""
