"""A walker who rides: vehicles and lifts that carry the walker while the feet stand still.

* `vehicles`: what moves and shakes a bus, a car, a train, a lift and an escalator, with the sources of the numbers.
* `vibration`: the vibration that reaches a passenger, from the road over suspension and body.
* `trip`: speed, stops and route of a vehicle.
* `riding_body`: the moving trunk of a walker who rides during some of the pauses of the walk.
"""
