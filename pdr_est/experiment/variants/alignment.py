"""Variants that know the fixes only by an alignment of the whole track, which comparisons must state."""

from collections.abc import Iterable, Mapping
from typing import Any

from pdr_est.config import import_folders
from pdr_est.estimators import SPECS
from pdr_est.experiment.variants.axes import TRACK_FILES, Variant
from pdr_est.parts import importable


def aligned_variants(variants: Iterable[Variant]) -> tuple[str, ...]:
    """Return the names of the variants whose estimator takes no measurement from fixes, or that are files of tracks.

    Both are moved and turned to fit the fixes.
    """
    aligned = []
    for variant in variants:
        if variant.track_files is not None:
            aligned.append(variant.name)
            continue
        with importable(import_folders(variant.config)):
            if not variant.config.estimator.make().spec.uses_fixes:
                aligned.append(variant.name)
    return tuple(aligned)


def aligned_in_file(variants: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the same for the section `variants` of a resolved experiment file.

    Estimators from outside the package, whose abilities are not known without their code, are left out.
    """
    return tuple(name for name, settings in variants.items() if _is_aligned(settings))


def _is_aligned(settings: Any) -> bool:
    if isinstance(settings, Mapping) and TRACK_FILES in settings:
        return True
    estimator = _estimator_in(settings)
    return estimator in SPECS and not SPECS[estimator].uses_fixes


def _estimator_in(settings: Any) -> Any:
    section = settings.get("estimator") if isinstance(settings, Mapping) else None
    return section.get("name") if isinstance(section, Mapping) else None
