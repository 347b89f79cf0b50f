"""The report of an experiment, which compares variants over many walks.

* `page`: the HTML page. `tables`, `plots`: its tables and still plots.
* `comparison_data`: what its scripts show. `curves`: numbers of its curves, for scripts and plots.
* `line_encoding`: tracks as short texts.
"""
