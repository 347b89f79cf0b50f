"""How long the tracker takes a sample: two phones at 100 Hz, every sample of every sensor pushed by itself.

Run: python experiments/online_latency.py [--minutes 2]
Prints p50, p99 and maximum of the time of one `Tracker.push`, in milliseconds, as the suite `speed` does: of the
processor and by the clock, which counts what else the machine does.
"""

import argparse

from pdr_est.performance.online import online_latency


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=2.0)
    arguments = parser.parse_args()
    for estimator, found in online_latency(arguments.minutes).items():
        print(f"{estimator}: {found['samples']:.0f} samples")
        for name, prefix in (("processor", ""), ("clock", "clock_")):
            p50, p99, most = (found[f"{prefix}{part}_ms"] for part in ("p50", "p99", "max"))
            print(f"{name:>10}: p50 {p50:.3f} ms, p99 {p99:.3f} ms, max {most:.1f} ms")


if __name__ == "__main__":
    main()
