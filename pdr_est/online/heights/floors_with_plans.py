"""The floors with their plans for a filter that works on plans, as the heights become known."""

from math import inf

from pdr_est.config import Config
from pdr_est.errors import FloorPlanError
from pdr_est.pipeline.inputs import refuse_unusable_plan
from pdr_est.pipeline.present_floors import FloorSequence
from pdr_est.types.floor_plan import BuildingPlan, FloorPlan, PresentFloor
from pdr_est.types.height import WalkerHeight


class FloorsWithPlans:
    """Hands the plan of the present floor from the heights to the filter.

    What is known about a second is handed on a few seconds later (`AROUND_MOVE_S`), and is not taken back.

    Parameters
    ----------
    plan
        Plan of the only floor, or of several; None for none.
    config
        Configuration, whose start has to be on the plan.

    Raises
    ------
    FloorPlanError
        For a plan that cannot be used, and for several floors where that of the start is not given.
    """

    def __init__(self, plan: FloorPlan | BuildingPlan | None, config: Config) -> None:
        refuse_unusable_plan(plan, config)
        if isinstance(plan, BuildingPlan) and plan.start_plan is None:
            raise FloorPlanError(
                f"{plan.name}: shows the floors {plan.floor_names}, and online nothing tells where the walk begins: "
                "say on which of them (--floor NAME, or BuildingPlan.start)"
            )
        self.plan = plan
        self._sequence = FloorSequence(plan) if isinstance(plan, BuildingPlan) else None
        self._changes: list[PresentFloor] = []
        self._last_s = -inf  # time of the last second

    def at_start(self) -> list[FloorPlan | PresentFloor]:
        """Return what the filter gets before everything else: the plans of all floors, that of the start last."""
        if isinstance(self.plan, BuildingPlan):
            floors = (*self.plan.plans, self.plan.start_plan)
            return [PresentFloor(-inf, one) for one in floors]
        return [] if self.plan is None else [self.plan]

    def add(self, second: WalkerHeight | None) -> None:
        """Take what is known about the next second."""
        if self._sequence is not None and second is not None and second.time_s > self._last_s:
            self._last_s = second.time_s
            self._changes += self._sequence.add(second)

    def take(self) -> list[PresentFloor]:
        """Return the changes of the floor since the last call."""
        found, self._changes = self._changes, []
        return found
