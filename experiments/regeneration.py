"""Run scripts whose code, arguments or data have changed since their results were recorded; for all.py."""

import ast
import hashlib
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from pdr_est.output.atomic_output import write_text

LIBRARIES = ("numpy", "scipy", "gtsam", "vqf", "filterpy", "scikit-learn", "polars", "matplotlib", "pygeomag")
"""Libraries whose version may change a number or a picture."""


@dataclass(frozen=True)
class Task:
    """Scripts that are run one after the other, because the results of one are compared with those of another.

    Attributes
    ----------
    name
        Name of the task.
    commands
        Script, or name of the package for its command line, and arguments of each command; "{data}" stands for the
        folder of the data sets, "{experiments}" for that of the scripts.
    data
        Folders of the data sets that are read; none for simulated walks.
    outputs
        Files, relative to the folder of the experiments, that the commands write.
    reads
        Recorded results that are read, as patterns relative to the folder of the experiments; tasks that write them
        run before.
    alone
        True for measurements of time or memory, beside which nothing else may run.
    minutes
        Usual duration on two cores, for somebody who waits.
    """

    name: str
    commands: tuple[tuple[str, ...], ...]
    outputs: tuple[str, ...]
    data: tuple[str, ...] = ()
    reads: tuple[str, ...] = ()
    alone: bool = False
    minutes: float = 1.0


@dataclass(frozen=True)
class Place:
    """Where scripts, package, results and record are.

    Attributes
    ----------
    experiments
        Folder of the scripts.
    package
        Folder of the package that they import.
    further
        Files and folders that count as code beside, such as fitted models.
    record
        File of the fingerprints.
    logs
        Folder of what the scripts print.
    data
        Folder of the data sets; None for none.
    """

    experiments: Path
    package: Path
    record: Path
    logs: Path
    further: tuple[Path, ...] = ()
    data: Path | None = None


@dataclass
class Outcome:
    """What became of the tasks, by name: `done` with the seconds, `failed` with the reason."""

    done: dict[str, float] = field(default_factory=dict)
    failed: dict[str, str] = field(default_factory=dict)
    unchanged: list[str] = field(default_factory=list)
    without_data: list[str] = field(default_factory=list)


def regenerate(
    tasks: Sequence[Task], place: Place, jobs: int = 1, force: bool = False, tell: Callable[[str], None] = print
) -> Outcome:
    """Run all tasks that need it, those first whose results others read; a failure does not stop the others.

    Only finished tasks are recorded, each when it ends, so that an interrupted run goes on where it was.
    """
    outcome, waiting = Outcome(), list(tasks)
    known = read_record(place.record)
    running: dict[Future[str], tuple[Task, float, str]] = {}
    with ThreadPoolExecutor(max_workers=max(jobs, 1)) as pool:
        while waiting or running:
            for task in [task for task in waiting if _may_start(task, waiting, running, jobs)]:
                if not _may_start(task, waiting, running, jobs):  # another one has started since
                    continue
                waiting.remove(task)
                state = state_of(task, place, known)
                if state == "no data":
                    outcome.without_data.append(task.name)
                elif state == "unchanged" and not force:
                    outcome.unchanged.append(task.name)
                else:
                    usual = usual_minutes(task, known)
                    tell(f"{time.strftime('%H:%M:%S')} {task.name}: started, usually {usual:g} min")
                    started = time.monotonic(), fingerprint(task, place)
                    running[pool.submit(_run, task, place)] = task, *started
            if running:
                ended, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in ended:
                    task, begin_s, code = running.pop(future)
                    _note(task, future.result(), time.monotonic() - begin_s, code, place, outcome, tell)
                    known = read_record(place.record)
    return outcome


def _may_start(
    task: Task, waiting: Sequence[Task], running: Mapping[Future[str], tuple[Task, float, str]], jobs: int
) -> bool:
    """Check that there is room, and that no task which writes what this one reads is still to end."""
    others = [other for other, _, _ in running.values()]
    if len(others) >= jobs or (others and (task.alone or any(other.alone for other in others))):
        return False
    unfinished = [*others, *(other for other in waiting if other is not task)]
    return not any(_reads_of(task, other) for other in unfinished)


def _reads_of(task: Task, other: Task) -> bool:
    return any(Path(output).match(pattern) for pattern in task.reads for output in other.outputs)


def _run(task: Task, place: Place) -> str:
    """Run the commands of a task; return the reason of a failure, empty for none."""
    place.logs.mkdir(parents=True, exist_ok=True)
    log = place.logs / f"{task.name}.log"
    paths = [str(place.package.parent), os.environ.get("PYTHONPATH", "")]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in paths if path)}
    with log.open("w", encoding="utf-8") as stream:
        for script, *arguments in task.commands:
            folders = {"data": place.data, "experiments": place.experiments}
            words = [argument.format(**folders) for argument in arguments]
            start = ["-m", script] if script == place.package.name else [str(place.experiments / script)]
            command = [sys.executable, *start, *words]
            code = subprocess.run(
                command, stdout=stream, stderr=subprocess.STDOUT, env=environment, check=False
            ).returncode
            if code:
                return f"{script} ended with exit code {code}: see {log}"
    missing = [output for output in task.outputs if not (place.experiments / output).is_file()]
    return f"did not write {', '.join(missing)}: see {log}" if missing else ""


def _note(
    task: Task,
    reason: str,
    seconds: float,
    code: str,
    place: Place,
    outcome: Outcome,
    tell: Callable[[str], None],
) -> None:
    """Record a task that has ended, with the fingerprint of when it began, and tell it."""
    if reason:
        outcome.failed[task.name] = reason
        tell(f"{time.strftime('%H:%M:%S')} {task.name}: FAILED after {seconds:.0f} s: {reason}")
        return
    outcome.done[task.name] = seconds
    record = read_record(place.record)
    digests = {"fingerprint": code, "outputs": output_digest(task, place)}
    record[task.name] = {**digests, "seconds": f"{seconds:.0f}"}
    write_text(place.record, json.dumps(dict(sorted(record.items())), indent=2) + "\n")
    tell(f"{time.strftime('%H:%M:%S')} {task.name}: done in {seconds:.0f} s")


def state_of(task: Task, place: Place, record: Mapping[str, Mapping[str, str]]) -> str:
    """Tell the state of a task: "no data", "unchanged", "changed" or "never recorded"."""
    if task.data and (place.data is None or not all((place.data / name).is_dir() for name in task.data)):
        return "no data"
    if task.name not in record:
        return "never recorded"
    now = {"fingerprint": fingerprint(task, place), "outputs": output_digest(task, place)}
    return "unchanged" if now.items() <= record[task.name].items() else "changed"


def usual_minutes(task: Task, record: Mapping[str, Mapping[str, str]]) -> float:
    """Return how long a task took when it was recorded, or how long it usually takes, minutes."""
    seconds = record.get(task.name, {}).get("seconds", "")
    return round(int(seconds) / 60.0, 1) if seconds.isdigit() else task.minutes


def read_record(path: Path) -> dict[str, dict[str, str]]:
    """Read the recorded fingerprints; none if there is no such file or it is damaged, so that everything runs."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        return {str(name): {str(key): str(text) for key, text in one.items()} for name, one in found.items()}
    except (OSError, ValueError, AttributeError):
        return {}


def fingerprint(task: Task, place: Place) -> str:
    """Compute the digest of all that the results depend on: code, arguments, data, libraries and results read.

    The code is that of the scripts and of every module that they import, directly or not, without comments and
    docstrings. The data count by the names and sizes of their files.
    """
    parts = [repr(task.commands), f"Python {sys.version_info.major}.{sys.version_info.minor}"]
    parts += [f"{name} {_version(name)}" for name in LIBRARIES]
    scripts = [
        place.package / "__main__.py" if command[0] == place.package.name else place.experiments / command[0]
        for command in task.commands
    ]
    parts += [f"{path.name} {code_digest(path)}" for path in imported_files(scripts, place)]
    parts += [f"{path.name} {_digest(path.read_bytes())}" for path in _all_files(place.further)]
    if place.data is not None:
        for name in task.data:
            files = _all_files([place.data / name])
            parts += [f"{path.relative_to(place.data).as_posix()} {path.stat().st_size}" for path in files]
    for pattern in task.reads:
        parts += [f"{path.name} {_digest(path.read_bytes())}" for path in sorted(place.experiments.glob(pattern))]
    return _digest("\n".join(parts).encode())


def output_digest(task: Task, place: Place) -> str:
    """Compute the digest of the files that a task has written; of missing ones it is another."""
    files = [place.experiments / output for output in task.outputs]
    digests = [_digest(path.read_bytes()) if path.is_file() else "missing" for path in files]
    return _digest("\n".join(digests).encode())


def imported_files(scripts: Sequence[Path], place: Place) -> list[Path]:
    """List the scripts and the modules of package and experiments that they import, directly or not.

    The package itself and its command line import by name what is asked for: a file that uses them counts as
    importing every module.
    """
    found: set[Path] = set()
    ahead = list(scripts)
    while ahead:
        path = ahead.pop()
        if path in found:
            continue
        found.add(path)
        if path != place.package / "__init__.py":
            ahead += [file for name in _imported_names(path) for file in _files_of(name, place)]
    return sorted(found)


def _files_of(name: str, place: Place) -> Iterator[Path]:
    """Find the module of a dotted name, and the packages that it is in; none for libraries."""
    first, *rest = name.split(".")
    if first != place.package.name:
        script = place.experiments / f"{first}.py"
        yield from [script] if script.is_file() else []
        return
    folder = place.package
    yield folder / "__init__.py"
    inside = [folder / f"{part}.py" for part in rest[:1]] + [folder / part / "__init__.py" for part in rest[:1]]
    if rest[:1] == ["cli"] or not any(file.is_file() for file in inside):
        yield from folder.rglob("*.py")
        return
    for part in rest:
        if (folder / f"{part}.py").is_file():
            yield folder / f"{part}.py"
            return
        folder = folder / part
        if not (folder / "__init__.py").is_file():
            return  # a name inside the module
        yield folder / "__init__.py"


@cache
def _imported_names(path: Path) -> tuple[str, ...]:
    """List the dotted names that a file imports, those inside of functions too."""
    names = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names += [f"{node.module}.{alias.name}" for alias in node.names]
    return tuple(names)


@cache
def code_digest(path: Path) -> str:
    """Compute the digest of a Python file without comments, docstrings and layout."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            node.body = [one for one in body if not _is_text(one)]  # type: ignore[attr-defined]
    return _digest(ast.dump(tree).encode())


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


def _all_files(places: Sequence[Path]) -> list[Path]:
    files = [file for path in places for file in (path.rglob("*") if path.is_dir() else [path])]
    return sorted(file for file in files if file.is_file())


def _version(library: str) -> str:
    try:
        return version(library)
    except PackageNotFoundError:
        return "missing"


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:16]
