"""The plan of the floor that the walker is on, at each time of a walk."""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, replace

from pdr_est.errors import EstimationError
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.estimators.particle.plan.plan_grid import PlanGrid, Window
from pdr_est.estimators.particle.plan.plan_model import PlanModel
from pdr_est.types.floor_plan import FloorPlan, PresentFloor
from pdr_est.types.measurements import DeviceMeasurements


class PlanModels:
    """Models of the plans of a building, each made once.

    Parameters
    ----------
    parameters
        Settings.
    window_m
        Part of the map that the walk cannot leave; None where it is not known.
    """

    def __init__(self, parameters: ParticleParams, window_m: Window | None = None) -> None:
        self._parameters, self._window_m = parameters, window_m
        self._made: list[tuple[FloorPlan, PlanModel]] = []

    def of(self, present: PresentFloor) -> PlanModel | None:
        """Return the model of the present floor; None without a plan.

        Where the floor is uncertain, its walls are as permeable as the floor is improbable.
        """
        if present.plan is None:
            return None
        model = next((model for plan, model in self._made if plan is present.plan), None)
        if model is None:
            model = PlanModel.of(present.plan, self._parameters, self._window_m)
            self._made.append((present.plan, model))
        if present.probability == 1.0:
            return model
        return replace(model, pass_probability=1.0 - present.probability * (1.0 - model.pass_probability))


@dataclass(frozen=True)
class PlansInTime:
    """Models of the plans of a walk.

    Attributes
    ----------
    begins_s
        Times from which on they count, s, in order.
    models
        A model for each; None between floors and on floors without a plan.
    """

    begins_s: tuple[float, ...]
    models: tuple[PlanModel | None, ...]

    @classmethod
    def of(
        cls, floors: Sequence[PresentFloor], parameters: ParticleParams, window_m: Window | None
    ) -> "PlansInTime | None":
        """Make the models of the floors of a walk, in order of time; None without any plan."""
        if all(one.plan is None for one in floors):
            return None
        made = PlanModels(parameters, window_m)
        return cls(tuple(one.time_s for one in floors), tuple(made.of(one) for one in floors))

    def at(self, time_s: float) -> PlanModel | None:
        """Return the model at a time; None before the first floor."""
        place = bisect_right(self.begins_s, time_s) - 1
        return None if place < 0 else self.models[place]

    def grid_at(self, time_s: float) -> PlanGrid | None:
        """Return the raster of the plan at a time."""
        model = self.at(time_s)
        return None if model is None else model.grid


def floors_among(devices: Sequence[DeviceMeasurements]) -> tuple[PresentFloor, ...]:
    """Return the present floors among the measurements of all devices, in order of time.

    A floor plan alone is that of the whole walk.

    Raises
    ------
    EstimationError
        For several floor plans without the times at which the walker is on their floors.
    """
    given = {id(m): m for one in devices for m in one.measurements if isinstance(m, FloorPlan | PresentFloor)}
    plans = [one for one in given.values() if isinstance(one, FloorPlan)]
    floors = [one for one in given.values() if isinstance(one, PresentFloor)]
    if len(plans) > 1 or (plans and floors):
        names = ", ".join(repr(plan.name) for plan in plans)
        raise EstimationError(
            f"{len(plans)} floor plans ({names}) for one time: give the one of the floor of the walk, or a "
            "PresentFloor for each time at which the floor changes"
        )
    alone = [PresentFloor(float("-inf"), plan) for plan in plans]
    return tuple(sorted([*alone, *floors], key=lambda one: one.time_s))
