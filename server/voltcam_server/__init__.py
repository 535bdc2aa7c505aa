"""The daemon: live video in, the events of a DAVIS out, over ZeroMQ and WebSocket, with REST beside them.

`emulator` is the loop, `transports` carry what it makes, `api` is REST and the page, `cli` the commands.
"""
