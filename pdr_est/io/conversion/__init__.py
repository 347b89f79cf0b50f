"""Conversion of recorded values to the units, axes and signs of the project.

=======  ===============================================================================================
file     content
=======  ===============================================================================================
units    detect the unit of accelerations, rotation rates, pressures and clocks from the values
signs    detect the sign of the acceleration and the direction of the attitude
axes     attitude and gravity of Android and Apple (Core Motion) in the project's axes
gnss     convert latitude and longitude to position fixes in the map frame
=======  ===============================================================================================
"""
