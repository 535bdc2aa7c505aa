"""`python -m voltcam_client.ros1`: `voltcam ros1`, where there is no such command on the path."""

import sys

from voltcam_client.cli import main

sys.exit(main(["ros1", *sys.argv[1:]]))
