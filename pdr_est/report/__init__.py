"""HTML reports: one file each that needs nothing but a browser.

* `walk`: the report and the result files of one walk (`pdr-est smooth`).
* `comparison`: the report of an experiment, which compares variants over many walks (`pdr-est experiment`).
* `plots`: the figures of a walk as SVG, with the colours and legends that all figures share.

The templates (`*.html.j2`) lie in this folder.
"""
