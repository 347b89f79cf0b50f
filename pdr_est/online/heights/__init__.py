"""Height and floor of the walker online.

* `pressure_seconds`: samples of the air pressure and times of steps become seconds.
* `told_heights`: heights of updates, which come again when they are revised.
* `floors_with_plans`: the plan of the present floor, for the filter.
"""
