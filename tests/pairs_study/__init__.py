"""One camera, two recordings: calibrated on the first, judged on the second, of another scene in other light.

`make pairs` writes docs/how-it-works/camera-pairs.md. Cameras are made by tests/generator, which shares no
code with simulator and lab, and have all that a real one has.
"""
