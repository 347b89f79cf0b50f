"""The report of an experiment, which compares variants over many walks.

* `page`: the HTML page. `tables`, `plots`: its parts.
"""
