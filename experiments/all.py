"""Regenerate everything under experiments/results, and the tables and pictures that are made of it.

    python experiments/all.py [--data DIR] [--only NAME ...] [--jobs N] [--force] [--list]

DIR holds the public data sets, as `pdr-est benchmark` wants them; without it the tasks that need them are left out,
and told. What has not changed since it was recorded is not run again: code (of the script and of all that it imports,
but not comments and docstrings), arguments, data, libraries, and the results that it reads. So a run that was
interrupted goes on where it was. A task that fails does not stop the others; the failed ones are told at the end,
with exit code 1.

--only NAME ... runs these tasks alone, --force whatever they are; --list tells the tasks, their state and how long
they usually take, and runs nothing. --jobs runs several at a time, but measurements of time and memory by themselves.

What the scripts print goes to build/experiments/TASK.log. The fingerprints are in
experiments/results/fingerprints.json.
"""

import argparse
import sys
from pathlib import Path

from regeneration import Place, Task, read_record, regenerate, state_of, usual_minutes

ROOT = Path(__file__).resolve().parents[1]
SUITES: dict[str, tuple[tuple[str, ...], float]] = {  # what benchmark_tables.py compares, and minutes
    "ilc20": (("", "-headings", "-front-ends"), 60.0),
    "ipin2023": (("", "-front-ends"), 15.0),
    "oxiod": (("", "-headings", "-front-ends"), 60.0),
    "phone-gps": (("", "-headings", "-front-ends"), 15.0),
    "walks": (("",), 60.0),
    "oxford-steps": (("",), 5.0),
    "weallwalk": (("", "-detectors", "-headings"), 30.0),
    "known-distance": (("", "-length-models"), 3.0),
    "stride-length": (("",), 10.0),
    "motionsense": (("",), 10.0),
    "gait": (("",), 10.0),
}
DATA_OF = {"gait": ("motionsense", "sisfall")}  # of the others the folder has the name of the suite


def results(stem: str, *endings: str) -> tuple[str, ...]:
    """List the results of a stem: .json and .txt, and others."""
    return tuple(f"results/{stem}{ending}" for ending in (".json", ".txt", *endings))


def benchmark(suite: str) -> Task:
    """Make the task of a benchmark suite."""
    stems, minutes = SUITES[suite]
    return Task(
        f"benchmark-{suite}",
        (("benchmark_tables.py", "--data", "{data}", "--suite", suite),),
        tuple(output for stem in stems for output in results(f"{suite}{stem}")),
        data=DATA_OF.get(suite, (suite,)),
        minutes=minutes,
    )


def simulated(stem: str, minutes: float, *endings: str, reads: tuple[str, ...] = ()) -> Task:
    """Make the task of a script that simulates its walks."""
    return Task(stem, ((f"{stem}.py",),), results(stem, *endings), reads=reads, minutes=minutes)


def recorded(stem: str, data: tuple[str, ...], minutes: float, *endings: str) -> Task:
    """Make the task of a script that reads data sets."""
    return Task(stem, ((f"{stem}.py", "--data", "{data}"),), results(stem, *endings), data=data, minutes=minutes)


LENGTH_SETS = ("ipin2023", "known-distance", "stride-length", "oxiod", "phone-gps", "ilc20", "walks")
TASKS: tuple[Task, ...] = (
    simulated("mmpdr_table6", 1.0),
    simulated("mmpdr_table7", 0.5),
    simulated("mmpdr_tables8_9", 1.0),
    # the curves of the figures are compared with the table
    Task(
        "mmpdr_table10",
        (("mmpdr_table10.py",), ("mmpdr_figures.py",)),
        (
            *results("mmpdr_table10"),
            *results("mmpdr_figures"),
            *(f"results/mmpdr_figure{number}.png" for number in (10, 11, 13)),
        ),
        minutes=30.0,
    ),
    simulated("psp_table1", 30.0),
    simulated("psp_figure3", 1.0, ".png", reads=("results/psp_table1.json",)),
    simulated("robust_dr_figure4", 50.0, ".png"),
    simulated("mmpdr_causes", 5.0),
    simulated("turned_walkers", 30.0),
    recorded("passengers", ("walks",), 3.0),
    recorded("plan_in_graph", ("ilc20",), 3.0),
    recorded("unknown_start", ("ilc20",), 8.0),
    recorded("wrong_plans", ("ilc20",), 25.0),
    recorded("uptime_table2", ("motionsense", "sisfall"), 5.0),
    recorded("uptime_table3", ("oxford-steps",), 3.0),
    recorded("uptime_table4", ("motionsense", "sisfall"), 10.0),
    recorded("uptime_figure6", ("oxford-steps",), 1.0, ".png"),
    recorded("uptime_figure7", ("known-distance", "stride-length"), 0.5, ".png"),
    recorded("uptime_figures8_9", ("known-distance", "phyphox", "phone-gps"), 3.0, ".png"),
    Task(
        "simulated_gaits",
        (("simulated_gaits.py", "--data", "{data}"),),
        ("results/simulated_gaits.png", "results/simulated_gaits.txt"),
        data=("motionsense", "sisfall"),
        minutes=0.5,
    ),
    recorded("step_length_fit", LENGTH_SETS, 20.0),
    Task(
        "gait_changes",
        (("gait_changes.py", "--data", "{data}"),),
        ("results/gait_changes.txt",),
        data=("motionsense", "sisfall"),
        minutes=5.0,
    ),
    Task(
        "simulated_and_real",
        (("simulated_and_real.py", "--data", "{data}"),),
        ("results/simulated_and_real.png", "results/simulated_and_real.txt"),
        data=("phyphox", "ilc20", "known-distance", "phone-gps", "motionsense", "oxiod", "sensor-logger"),
        minutes=3.0,
    ),
    *(benchmark(suite) for suite in SUITES),
    Task("front_end_cost", (("front_end_cost.py",),), ("results/front_end_cost.txt",), alone=True),
    Task("online_memory", (("online_memory.py",),), ("results/online_memory.txt",), alone=True, minutes=60.0),
    Task("live_numbers", (("live_numbers.py",),), ("results/live_numbers.txt",), alone=True, minutes=12.0),
    Task(
        "speed",
        (("pdr_est", "benchmark", "speed", "--json", "{experiments}/results/speed.json"),),
        ("results/speed.json",),
        alone=True,
        minutes=30.0,
    ),
    # these put numbers and pictures on pages, and come when all that they read is there
    Task(
        "paper_tables",
        (("paper_tables.py",),),
        (),
        reads=("results/mmpdr_*", "results/psp_*", "results/robust_dr_*", "results/uptime_*"),
    ),
    Task("latency_tables", (("latency_tables.py",),), ()),
    Task("readme_pictures", (("readme_pictures.py",),), ()),
)
NOT_RUN = {
    "all",
    "regeneration",
    "recorded",  # parts of the scripts
    "overview",
    "limb_statistics",
    "mmpdr_walks",
    "walks_on_plans",
    "benchmark_tables",  # a task for each suite
    "mmpdr_figures",  # with mmpdr_table10
    "front_end_acceptance",  # prints only
}
"""Scripts without a task of their name."""


def main() -> int:
    """Regenerate, tell what became of each task, and return the exit code."""
    names = [task.name for task in TASKS]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path)
    parser.add_argument("--only", nargs="+", choices=names, metavar="NAME", default=names)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--force", action="store_true")
    parser.add_argument("--list", action="store_true")
    options = parser.parse_args()
    place = place_with(None if options.data is None else options.data.resolve())
    tasks = [task for task in TASKS if task.name in options.only]
    if options.list:
        record = read_record(place.record)
        for task in tasks:
            print(f"{task.name:28}{usual_minutes(task, record):6g} min  {state_of(task, place, record)}")
        return 0
    outcome = regenerate(tasks, place, options.jobs, options.force)
    print(f"\nrecorded anew: {', '.join(outcome.done) or 'nothing'}")
    print(f"unchanged: {', '.join(outcome.unchanged) or 'nothing'}")
    if outcome.without_data:
        print(f"left out, no data (--data DIR): {', '.join(outcome.without_data)}")
    for name, reason in outcome.failed.items():
        print(f"FAILED {name}: {reason}")
    return 1 if outcome.failed else 0


def place_with(data: Path | None) -> Place:
    """Return the places of this repository."""
    experiments = ROOT / "experiments"
    return Place(
        experiments=experiments,
        package=ROOT / "pdr_est",
        record=experiments / "results" / "fingerprints.json",
        logs=ROOT / "build" / "experiments",
        further=(ROOT / "models",),
        data=data,
    )


if __name__ == "__main__":
    sys.exit(main())
