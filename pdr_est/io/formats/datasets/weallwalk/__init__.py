"""WeAllWalk: walks of blind and sighted people with two iPhones.

===========  ===========================================================================================
file         content
===========  ===========================================================================================
reader       sensor tables of both phones
annotations  heel strikes and turns, the ground truth
===========  ===========================================================================================
"""
