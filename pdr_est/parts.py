"""Parts of the user's own: stages and estimators from outside the package, as objects or by dotted name.

In Python they are given as objects, in `Parts`. In YAML the name of a part may be `module:attribute`: the module is
imported, and the attribute is called with the parameters that stand beside the name. Nothing else is executed.
"""

import inspect
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from copy import deepcopy
from dataclasses import dataclass, fields
from functools import reduce
from importlib import import_module
from pathlib import Path
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from pdr_est.errors import ConfigError
from pdr_est.params.validation_messages import brief, nearest
from pdr_est.stage import Stage

STAGE = ("push", "flush", "latency_s")
"""Attributes of a stage."""

ESTIMATOR = ("estimate", "spec")
"""Attributes of an estimator."""

_DOTTED = r"^[A-Za-z_]\w*(\.[A-Za-z_]\w*)*:[A-Za-z_]\w*(\.[A-Za-z_]\w*)*$"

StagePart = Stage | Callable[..., Stage]
"""Stage that serves as a prototype and is copied for each device, or a factory of stages."""


@dataclass(frozen=True)
class Parts:
    """Stages and an estimator of the user's own, each in place of the one that the configuration names.

    A stage has state, so each device gets one of its own: a factory (a class or a function) is called for each
    device, a stage that was made already is copied for each device as it is. A factory is called with those of the
    arguments `rate_hz` (working rate, Hz) and, for the step length, `walker` (`WalkerParams`) that it takes.

    Attributes
    ----------
    mode
        Recogniser of the carrying mode, `LevelBlock` -> `LevelBlock`.
    step_detector
        Step detector, `LevelBlock` -> `StepEvent`.
    gait, step_length, heading
        Stages `Step` -> `Step`, in this order of the chain.
    estimator
        Estimator (`pdr_est.estimators.spec.Estimator`), or a factory of estimators that takes no argument.
    """

    mode: StagePart | None = None
    step_detector: StagePart | None = None
    gait: StagePart | None = None
    step_length: StagePart | None = None
    heading: StagePart | None = None
    estimator: Any = None

    def __post_init__(self) -> None:
        for entry in fields(self):
            part, contract = getattr(self, entry.name), ESTIMATOR if entry.name == "estimator" else STAGE
            if part is not None and not callable(part):
                _refuse_incomplete(part, contract, f"Parts: {entry.name} = {brief(part)}")

    @property
    def modules(self) -> frozenset[str]:
        """Names of the modules in which the parts, or their classes, are defined."""
        own = [getattr(self, entry.name) for entry in fields(self)]
        return frozenset(getattr(part, "__module__", type(part).__module__) for part in own if part is not None)


NO_PARTS = Parts()


class PartError(ConfigError):
    """A part cannot be made.

    Attributes
    ----------
    below
        Keys below the section of the part that lead to the setting to blame; empty for the name of the part.
    """

    def __init__(self, message: str, below: tuple[str, ...] = ()) -> None:
        super().__init__(message)
        self.below = below


@dataclass(frozen=True)
class PartName:
    """Annotation of a text field: one of some names, or the dotted name of a part of the user's own.

    Attributes
    ----------
    names
        Names of the parts that the package has.
    """

    names: tuple[str, ...]

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Validate the text."""
        return core_schema.no_info_after_validator_function(self._validated, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Describe the text for editors."""
        return {"anyOf": [{"enum": list(self.names)}, {"type": "string", "pattern": _DOTTED}]}

    def _validated(self, name: str) -> str:
        if name in self.names or re.match(_DOTTED, name):
            return name
        words = f"Input should be {', '.join(map(repr, self.names))}, or module:attribute for a part of your own"
        raise PydanticCustomError("unknown_part", "{words}", {"words": words})


def is_external(name: str) -> bool:
    """Check whether the name of a part is the dotted name of one of the user's own."""
    return ":" in name


def named_part(
    name: str, parameters: Mapping[str, Any], contract: Sequence[str], key: str, offered: Mapping[str, Any]
) -> Any:
    """Make the part of a dotted name.

    Parameters
    ----------
    name
        `module:attribute`. The attribute is a factory, or a part that is copied.
    parameters
        Arguments of the factory from the configuration.
    contract
        Attributes that the part must have.
    key
        Key of the name in the configuration, for messages.
    offered
        Further arguments, which the factory gets if it takes them.

    Raises
    ------
    PartError
        For a module or an attribute that is not found, for wrong parameters, for a factory that fails, and for an
        object that lacks an attribute of the contract.
    """
    return _made(loaded(name, key), parameters, contract, f"{key} = {name!r}", offered)


def given_part(part: Any, contract: Sequence[str], place: str, offered: Mapping[str, Any]) -> Any:
    """Make a part from an object or a factory that was given in Python; `named_part` explains the arguments."""
    return _made(part, {}, contract, place, offered)


def loaded(name: str, key: str) -> Any:
    """Import what a dotted name stands for; `named_part` explains the arguments and the errors."""
    place = f"{key} = {name!r}"
    module_name, _, attribute = name.partition(":")
    try:
        module = import_module(module_name)
    except ModuleNotFoundError as error:
        if error.name is None or not f"{module_name}.".startswith(f"{error.name}."):
            raise PartError(f"{place}: {module_name} needs the module {error.name}: install it") from error
        raise PartError(
            f"{place}: there is no module {error.name!r}: put it beside the configuration file, install it, or "
            "correct the name"
        ) from error
    except Exception as error:  # whatever the module of the user runs into
        raise PartError(f"{place}: {module_name} cannot be imported ({_in_words(error)}): correct it") from error
    try:
        return reduce(getattr, attribute.split("."), module)
    except AttributeError as error:
        public = [known for known in vars(module) if not known.startswith("_")]
        raise PartError(f"{place}: {module_name} has no {attribute!r}: {nearest(attribute, public)}") from error


@contextmanager
def importable(folders: Iterable[str | Path]) -> Iterator[None]:
    """Let modules in some folders be imported, those of all installed packages first; restore the path afterwards."""
    before = list(sys.path)
    sys.path.extend(str(folder) for folder in folders if str(folder) not in before)
    try:
        yield
    finally:
        sys.path[:] = before


def folder_of(name: str) -> str | None:
    """Find the folder from which the module of a dotted name was imported; None if it has no file."""
    file = _root_file(name)
    if file is None:
        return None
    return str(file.parent.parent if file.name == "__init__.py" else file.parent)


def files_of(name: str) -> list[Path]:
    """List the source files of the module of a dotted name, or of the package in which it lies."""
    file = _root_file(name)
    if file is None:
        return []
    return sorted(file.parent.rglob("*.py")) if file.name == "__init__.py" else [file]


def _root_file(name: str) -> Path | None:
    file = getattr(sys.modules.get(_root(name)), "__file__", None)
    return None if file is None else Path(file)


def _root(name: str) -> str:
    """Name the module or package at the top of a dotted name."""
    return name.partition(":")[0].partition(".")[0]


def refuse_other_module(name: str, folder: Path, place: str) -> None:
    """Raise PartError if a folder holds the module of a dotted name but another module of that name was imported."""
    root = _root(name)
    found = folder_of(name)
    beside = (folder / f"{root}.py").is_file() or (folder / root / "__init__.py").is_file()
    if beside and found is not None and Path(found).resolve() != folder.resolve():
        raise PartError(f"{place}: another module {root!r} was imported from {found}: rename the one in {folder}")


def _made(
    part: Any, parameters: Mapping[str, Any], contract: Sequence[str], place: str, offered: Mapping[str, Any]
) -> Any:
    """Call a factory, or copy a part, and check what came of it."""
    if not isinstance(part, type) and all(hasattr(part, name) for name in contract):
        if parameters:
            raise PartError(
                f"{place}: is an object and takes no parameters: name a class or function", ("parameters",)
            )
        return deepcopy(part)
    if not callable(part):
        raise PartError(f"{place}: is {brief(part)}: name a class or a function that makes the part")
    arguments = _arguments(part, parameters, place, offered)
    try:
        made = part(**arguments)
    except ConfigError as error:
        raise PartError(f"{place}: {error}", ("parameters",)) from error
    except Exception as error:  # whatever the factory of the user runs into
        raise PartError(
            f"{place}: cannot be made ({_in_words(error)}): correct its parameters or its code"
        ) from error
    _refuse_incomplete(made, contract, place)
    return made


def _arguments(
    factory: Callable[..., Any], parameters: Mapping[str, Any], place: str, offered: Mapping[str, Any]
) -> dict[str, Any]:
    """Collect the arguments of a factory. Raises PartError for one that it does not take, or that is missing."""
    try:
        taken = inspect.signature(factory).parameters
    except ValueError:  # of a builtin
        return dict(parameters)
    named = (inspect.Parameter.KEYWORD_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    known = [name for name, one in taken.items() if one.kind in named]
    takes_any = any(one.kind is inspect.Parameter.VAR_KEYWORD for one in taken.values())
    for name in parameters:
        if name in offered:
            words = f"parameter {name!r} is given by the pipeline: leave it out"
            raise PartError(f"{place}: {words}", ("parameters", name))
        if name not in known and not takes_any:
            free = [one for one in known if one not in offered]
            remedy = nearest(name, free) if free else "it takes none"
            raise PartError(f"{place}: takes no parameter {name!r}: {remedy}", ("parameters", name))
    arguments = {**{name: value for name, value in offered.items() if name in known}, **parameters}
    required = [name for name in known if taken[name].default is inspect.Parameter.empty]
    missing = [name for name in required if name not in arguments]
    if missing:
        below = ("parameters",) if parameters else ()
        raise PartError(f"{place}: parameter {missing[0]!r} is missing: give it", below)
    return arguments


def _refuse_incomplete(part: Any, contract: Sequence[str], place: str) -> None:
    missing = [name for name in contract if not hasattr(part, name)]
    if missing:
        kind = "a stage" if contract == STAGE else "an estimator"
        raise PartError(
            f"{place}: {type(part).__name__} has no {', '.join(missing)}: {kind} needs {', '.join(contract)}"
        )


def _in_words(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"
