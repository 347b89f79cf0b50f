"""The card of a gait model in Markdown: purpose, training data, accuracy and limits."""

from collections.abc import Iterator
from datetime import date
from importlib.metadata import version

from pdr_est.front_end.gait.evaluation import ALL
from pdr_est.front_end.gait.folds import GaitFolds
from pdr_est.front_end.gait.model import GaitMetrics, GaitModel, model_digest
from pdr_est.front_end.gait.training import TrainedGait
from pdr_est.training.gait_files import OWN

_PUBLIC = ("motionsense", "sisfall")
_CHOSEN = (
    " The features and the costs of errors were chosen on the people of MotionSense and SisFall, so expect a little "
    "less on new ones."
)
_NAMES = ("walking", "jogging", "running")

_LIMITS = """\
* Labels agree on walking against faster. **Jogging against running is relative to the person**: one person's slow run
  is as intense as another's quick one. The second level learns only from people who were recorded in both gaits.
  Read its answer as "below or above the usual effort", and use the probabilities rather than the class where lengths
  depend on it.
* Every step has the gait of its file. Slow steps at starts, turns and stops of a jog therefore count as errors.
* Without a gyroscope the vertical acceleration is taken from the magnitude, and more steps of joggers are missed.
* Very quick walkers (above 2.2 steps a second) are the hardest to tell from joggers.
"""

_LIMITS_OF = {
    "motionsense": """\
* MotionSense: phones in the front trouser pocket of adults. It has jogging only, most of it more intense than
  SisFall's quick jogging, so that a model of both classifies nearly all of it as running.
""",
    "sisfall": """\
* SisFall: a box at the belt of adults on level ground, with a gyroscope. People were asked to jog slowly (D03) and
  quickly (D04), and these stand in for jogging and running.
""",
    OWN: """\
* Own recordings: their labels and the place of the phone have not been checked.
""",
}

_UNSEEN_PUBLIC = """\
* The training data have no running with the phone in the hand, no older people, children, treadmills or stairs.
  With the phone held in front, brisk walkers with a bouncing hand are sometimes classified as joggers.
"""


def model_card(trained: TrainedGait, trained_on: date, recordings_sha256: str) -> str:
    """Write the card; it depends only on the arguments and the version of scikit-learn."""
    model = trained.model
    parts = [
        f"# Gait model `{model.features}`",
        "Recognises walking, jogging and running for each step, with two support-vector machines in a row (UPTIME, "
        "figure 5): walking or faster, then jogging or running. It is plain numbers in JSON; reading it executes "
        "nothing.",
        f"* SHA-256 inside the file: `{model_digest(model)}`\n"
        f"* Trained {trained_on.isoformat()} with scikit-learn {version('scikit-learn')}. The date is here and "
        "not in the model, so that the same recordings give the same bytes.\n"
        f"* Made by `pdr-est train-gait --data DIR --features {model.features} -o OUT`",
        "## Data\n\n" + "\n".join(_data(model)),
        f"SHA-256 over names and contents of the recordings: `{recordings_sha256}`",
        "## Accuracy for people left out of the training\n\n" + "\n".join(_figures(model, trained.folds)),
        "## Limits\n\n" + _limits(model).rstrip(),
    ]
    return "\n\n".join(parts) + "\n"


def _limits(model: GaitModel) -> str:
    """Write the limits of every model, and those of its data sets."""
    names = [data.name for data in model.data]
    unseen = "" if OWN in names else _UNSEEN_PUBLIC
    return _LIMITS + "".join(text for name, text in _LIMITS_OF.items() if name in names) + unseen


def _data(model: GaitModel) -> Iterator[str]:
    yield "| data set | people | recordings | steps walking | jogging | running |"
    yield "|---|---|---|---|---|---|"
    for data in model.data:
        yield f"| {data.name} | {data.people} | {data.recordings} | {' | '.join(map(str, data.steps))} |"
    yield f"\nPeople: {', '.join(model.people)}."


def _figures(model: GaitModel, folds: GaitFolds) -> Iterator[str]:
    yield (
        f"Every figure is per step, for people whom the model had not seen: {len(folds.models)} models were trained "
        "in the same way, each without the people it is tested on; neither its machines nor its probabilities have "
        f"seen them.{_CHOSEN if {data.name for data in model.data} & set(_PUBLIC) else ''}\n"
    )
    metrics = model.metrics
    if metrics is None:
        return
    yield "| data set | walking against faster | three gaits, balanced |"
    yield "|---|---|---|"
    for name, accuracy in metrics.faster_accuracy.items():
        yield f"| {name} | {100.0 * accuracy:.2f} % | {100.0 * metrics.balanced_accuracy[name]:.2f} % |"
    first, second = metrics.brier
    yield f"\nBrier score of the probabilities: {first:.4f} of walking or faster, {second:.4f} of jogging or running."
    for name in metrics.confusion:
        yield from _confusion(metrics, name)


def _confusion(metrics: GaitMetrics, name: str) -> Iterator[str]:
    yield f"\nSteps of {'all data sets' if name == ALL else name}, true gait by row, recognised gait by column:\n"
    yield f"| | {' | '.join(_NAMES)} |"
    yield "|---|---|---|---|"
    for gait, row in zip(_NAMES, metrics.confusion[name], strict=True):
        if sum(row):
            yield f"| {gait} | {' | '.join(map(str, row))} |"
