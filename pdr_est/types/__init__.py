"""Records that the parts of the library exchange: frozen dataclasses of arrays, in SI units.

| module | records |
|---|---|
| `sensors` | samples of one device: raw blocks, blocks on the uniform working grid, blocks with gravity resolved |
| `steps` | carrying modes, gaits, detected steps |
| `measurements` | the input of every estimator: step odometry, heading priors, position fixes, tethers, start pose |
| `recording` | the output of every reader: the signals of all devices of one walk |
| `ground_truth` | reference data of a recording, for evaluation only |
| `clock` | offset and skew of one clock against another |
| `track` | the output of every estimator: poses with covariance |
| `analysis` | intermediate results of one walk: front-end output of each device, and the track made from it |
| `outcome` | one scored track of an experiment, as the comparison report shows it |
"""
