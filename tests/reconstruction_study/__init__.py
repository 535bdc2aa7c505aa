"""Networks that reconstruct images, trained on the events of several models and tested on a real camera's.

`make study-reconstruction` runs it and writes docs/how-it-works/reconstruction-study.md.
"""
