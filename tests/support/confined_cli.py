"""The command line in a process of its own, which may be slow, fill the memory or die without harm to the tests."""

import base64
import json
import os
import select
import subprocess
import sys
import traceback
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

LONGEST_S, MOST_MIB = 20.0, 1024.0
_BASE_MIB = 700.0  # a worker that has ever used more begins anew, so that the peak of a call is its own
_START_S = 60.0


@dataclass(frozen=True)
class Answer:
    """What a call left: exit code, both streams, CPU time, peak memory of the process, a traceback if it raised."""

    exit_code: int
    stdout: str
    stderr: str
    seconds: float
    peak_mib: float
    crash: str


class ConfinedCli:
    """A worker process that runs one call of `pdr-est` after the other."""

    def __init__(self) -> None:
        self._worker: subprocess.Popen[bytes] | None = None

    def call(self, *arguments: object, stdin: bytes = b"") -> Answer:
        """Run a call; one that takes too long has exit code -1."""
        worker = self._worker or self._start()
        assert worker.stdin is not None
        request = {"arguments": [str(one) for one in arguments], "stdin": base64.b64encode(stdin).decode()}
        worker.stdin.write(json.dumps(request).encode() + b"\n")
        worker.stdin.flush()
        line = self._line(LONGEST_S)
        if line is None:
            code = worker.poll()
            self.close()
            return Answer(-1, "", "", LONGEST_S, 0.0, f"no answer within {LONGEST_S:g} s, the process: {code}")
        answer = Answer(**json.loads(line))
        if answer.peak_mib > _BASE_MIB:
            self.close()
        return answer

    def close(self) -> None:
        """End the worker."""
        if self._worker is not None:
            self._worker.kill()
            self._worker.communicate()
            self._worker = None

    def _start(self) -> subprocess.Popen[bytes]:
        environment = os.environ | {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "POLARS_MAX")}
        self._worker = subprocess.Popen(
            [sys.executable, __file__],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=environment,
        )
        assert self._line(_START_S) is not None, "the worker does not start"
        return self._worker

    def _line(self, longest_s: float) -> bytes | None:
        assert self._worker is not None
        assert self._worker.stdout is not None
        ready, _, _ = select.select([self._worker.stdout], [], [], longest_s)
        return (self._worker.stdout.readline() or None) if ready else None


def serve() -> None:
    """Answer calls, a line of JSON each, until standard input ends."""
    import time

    from click.testing import CliRunner

    from pdr_est.cli import main
    from pdr_est.performance.memory import peak_mb

    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    print("{}", file=answers, flush=True)
    for line in sys.stdin:
        request: dict[str, Any] = json.loads(line)
        begin = time.process_time()
        result = CliRunner().invoke(main, request["arguments"], input=base64.b64decode(request["stdin"]))
        raised = result.exc_info if result.exception and not isinstance(result.exception, SystemExit) else None
        answer = Answer(
            exit_code=result.exit_code,
            stdout=result.stdout,
            stderr=result.stderr,
            seconds=time.process_time() - begin,
            peak_mib=peak_mb(),
            crash="".join(traceback.format_exception(*raised)) if raised else "",
        )
        print(json.dumps(answer.__dict__), file=answers, flush=True)


def complaints(answer: Answer) -> Sequence[str]:
    """Say what is wrong with the end of a call: nothing, if it did its work or refused the input in words."""
    last = answer.stderr.rstrip("\n").rsplit("\n", 1)[-1]
    found = {
        f"crash: {answer.crash[-1500:]}": bool(answer.crash),
        f"exit code {answer.exit_code}": answer.exit_code not in (0, 2),
        f"{answer.seconds:.1f} s of CPU time": answer.seconds > LONGEST_S,
        f"{answer.peak_mib:.0f} MiB": answer.peak_mib > MOST_MIB,
        f"no error line: {answer.stderr[-500:]!r}": answer.exit_code == 2 and not last.startswith("Error: "),
        f"an error line of {len(last)} characters": len(last) > 1500,
    }
    return [words for words, wrong in found.items() if wrong]


if __name__ == "__main__":
    serve()
