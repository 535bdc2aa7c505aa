"""From a folder of videos to a data set: `voltcam dataset make`, `check` and `show`.

`spec` is what is asked for, `clips` the inputs it names, `probe` looks at them before hours are spent, `item`
makes one, `make` all of them on an `engines` of one machine or many, `manifest` says what was made.
"""
