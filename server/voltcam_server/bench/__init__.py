"""How fast Voltcam is here: `voltcam bench`. Each figure stands beside what the machine itself can do.

`cli` is the command and the sensor, `live` a daemon at a camera's rate, `transports` how events reach another
process (`senders`, `receivers`, and `plain` sockets beside them), `cuda` a sensor on a GPU.
"""
