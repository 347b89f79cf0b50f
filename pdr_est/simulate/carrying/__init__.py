"""Ways to carry a phone: each puts the device on the walking body.

* `device_pose`: pose of a device on a moving limb, the protocol of a carrying model, and the resulting motion.
* `held_phone`, `swinging_phone`, `pocket_phone`: the carrying modes HOLDING, SWING and POCKET.
* `mode_changes`: a hand moves the phone from one place to the next; the true modes over time.
"""
