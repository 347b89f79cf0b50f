"""Smooth walks whose positions nothing measures: the estimator `factor-graph` without a graph.

If neither position fixes, a closed walk nor tethers measure the position, a step fits any two headings at its ends
exactly: the positions follow from the headings, and the optimum of the factor graph is that of a chain of headings
with one more variable, the direction that relative heading priors count from. The chain is solved directly, which is
about a hundred times faster than the elimination of the graph; the result is the same.

* `chain`: the chain, and its optimum by iteratively reweighted least squares.
* `initial_headings`: where the iteration begins.
* `chain_marginals`: covariances of headings and positions at the optimum.
* `chain_smoother`: which walks are smoothed this way, and their track.
"""
