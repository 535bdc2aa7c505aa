"""The hidden-effects grid: recordings with an effect in them that the diagnosis is not told of.

    make hidden-effects                            all of it, seeds from REPORTED_FROM on; writes the page
    make hidden-effects SEED=0 CASES='singles/*'   a part of it, on seeds for development

`cases` draws the grid, `ask` puts a recording to the diagnosis, `run` writes down what it says, case after
case, and `score` draws the answers only then. `page` tells.
"""
