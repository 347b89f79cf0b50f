"""Loading modules without garbage collection, which must go on afterwards."""

import gc

import pytest

from pdr_est.module_loading import loading_modules


def test_the_collector_rests_while_modules_are_loaded() -> None:
    with loading_modules():
        assert not gc.isenabled()
    assert gc.isenabled()


def test_a_failed_import_leaves_the_collector_on() -> None:
    with pytest.raises(ModuleNotFoundError), loading_modules():
        import no_such_module_of_any_package  # type: ignore[import-not-found]  # noqa: F401
    assert gc.isenabled()


def test_what_was_loaded_before_is_not_frozen_again() -> None:
    frozen = gc.get_freeze_count()
    with loading_modules():
        import json  # noqa: F401
    assert gc.get_freeze_count() == frozen
