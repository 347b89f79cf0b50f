"""Ready-made scenarios: named ones, and the walks of the papers' experiments.

* `named_scenarios`: scenarios by name, for `pdr-est demo` and experiment files.
* `mmpdr`, `psp`, `robust_dr`: the walks of MMPDR, of PSP and of Robust DR.
"""
