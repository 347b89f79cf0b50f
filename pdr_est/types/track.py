"""The track of a walk: the output of every estimator."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pdr_est.frames import Array
from pdr_est.types.findings import Finding
from pdr_est.types.height import HeightProfile
from pdr_est.types.on_plan.places import PlaceSearch
from pdr_est.types.region import PoseRegion, joined_regions
from pdr_est.types.track_output import table as track_table

if TYPE_CHECKING:
    import pandas
    import polars
    from matplotlib.axes import Axes

    from pdr_est.types.measurements import PositionFix

_POSE_FIELDS = (
    "time_s",
    "moving_from_s",
    "device",
    "position_m",
    "heading_rad",
    "covariance_m2",
    "sigma_heading_rad",
    "mode",
    "step_length_m",
)


@dataclass(frozen=True)
class Track:
    """Poses at the ends of the steps with their covariance; the start comes first, device by device.

    Attributes
    ----------
    time_s
        (n,) s on the clock of the recording.
    moving_from_s
        (n,) s, start of the movement towards each pose; the walker stands still before it.
    device
        (n,) name of the device, or "fused" for the person.
    position_m
        (n, 2) east and north, m, map frame.
    heading_rad
        (n,) rad, counter-clockwise from east.
    covariance_m2
        (n, 2, 2) m², covariance of the position, map frame.
    sigma_heading_rad
        (n,) rad, standard deviation of the heading.
    mode
        (n,) values of `CarryingMode`.
    step_length_m
        (n,) m, length of the step that leads to the pose.
    kind
        "filtered" (each pose estimated from the past only), "smoothed" (from the whole walk) or "delayed" (from the
        past and a fixed time after it).
    estimator
        Name of the estimator.
    length_scale, sigma_length_scale
        Estimated ratio of the walker's step length to that of the step-length model, and its standard deviation.
    findings
        What does not fit in the walk as a whole, and what the estimator chose: the same for every device.
    height
        Height and floor of the walker over time; None where no device recorded the air pressure.
    region
        Mixture of normal distributions for each position, from estimators whose posterior need not be normal; None
        from all others, and where the mixture is not known.
    on_plan
        True if a floor plan kept the track off its walls, and tied it to the map.
    places
        Search for the place of a walk that may have begun anywhere on its floor plan; None for other walks.
    """

    time_s: Array
    moving_from_s: Array
    device: NDArray[np.str_]
    position_m: Array
    heading_rad: Array
    covariance_m2: Array
    sigma_heading_rad: Array
    mode: NDArray[np.int8]
    step_length_m: Array
    kind: str
    estimator: str
    length_scale: float = 1.0
    sigma_length_scale: float = 0.0
    findings: tuple[Finding, ...] = ()
    height: HeightProfile | None = None
    region: PoseRegion | None = None
    on_plan: bool = False
    places: PlaceSearch | None = None

    def __len__(self) -> int:
        return len(self.time_s)

    def __repr__(self) -> str:
        span_s = float(self.time_s.max() - self.time_s.min()) if len(self) else 0.0
        names = ", ".join(self.devices)
        return f"Track({self.estimator}, {self.kind}: {len(self)} poses of {names}, {span_s:.1f} s)"

    def _repr_html_(self) -> str:
        """Show a table and a drawing in notebooks."""
        from pdr_est.types.track_output.drawing import track_html

        return track_html(self)

    @property
    def devices(self) -> tuple[str, ...]:
        """Names of the devices in order of first appearance."""
        return tuple(dict.fromkeys(map(str, self.device.tolist())))

    @property
    def distance_m(self) -> float:
        """Length of the polyline through the poses, m, summed over the devices."""
        legs = np.linalg.norm(np.diff(self.position_m, axis=0), axis=1)
        return float(legs[self.device[1:] == self.device[:-1]].sum())

    def of_device(self, device: str) -> "Track":
        """Select the poses of one device."""
        return self.rows_where(self.device == device)

    def rows_where(self, chosen: NDArray[np.bool_] | NDArray[np.intp] | NDArray[np.int64]) -> "Track":
        """Select poses by a mask (n,) or by their indices, each as often as it is named."""
        columns: dict[str, Any] = {name: getattr(self, name)[chosen] for name in _POSE_FIELDS}
        return replace(self, **columns, region=None if self.region is None else self.region.rows(chosen))

    def moved(self, shift_m: Array) -> "Track":
        """Move each pose and its region by (n, 2), or all of them by (2,), m."""
        region = None if self.region is None else self.region.shifted(shift_m)
        return replace(self, position_m=self.position_m + shift_m, region=region)

    def at(self, time_s: ArrayLike) -> tuple[Array, Array]:
        """Interpolate the track of one device linearly between its poses.

        Between two steps the walker stands until the next step begins. Times outside the track take its first or
        last pose.

        Parameters
        ----------
        time_s
            (k,) s, in any order; a single number counts as one time.

        Returns
        -------
        position_m : Array
            (k, 2) east and north, m.
        covariance_m2 : Array
            (k, 2, 2) m².

        Raises ValueError if the track has several devices.
        """
        if len(self.devices) > 1:
            raise ValueError(f"the track has several devices {self.devices}: choose one with of_device()")
        wanted = np.atleast_1d(np.asarray(time_s, dtype=np.float64))
        before, after, share = bracketing_poses(self.time_s, self.moving_from_s, wanted)
        position = self.position_m[before] + share[:, None] * (self.position_m[after] - self.position_m[before])
        covariance = self.covariance_m2[before] + share[:, None, None] * (
            self.covariance_m2[after] - self.covariance_m2[before]
        )
        return position, covariance

    def to_csv(self, path: str | Path) -> None:
        """Write the track table `track.csv`, one row for each pose, numbers rounded to 0.1 mm or finer."""
        track_table.write_csv(self, path)

    @classmethod
    def from_csv(cls, path: str | Path, *, kind: str = "unknown", estimator: str = "unknown") -> "Track":
        """Read a track table that `to_csv` wrote.

        Parameters
        ----------
        path
            The file, usually `track.csv`.
        kind, estimator
            Properties that the table does not hold. Nor does it hold `on_plan` and `moving_from_s`: the walker counts
            as moving all the time between two poses.

        Raises
        ------
        RecordingError
            If the file is no such table.
        """
        return cls(**track_table.read_csv(path), kind=kind, estimator=estimator)

    def to_polars(self) -> "polars.DataFrame":
        """Return the track table as a polars data frame, numbers not rounded."""
        return track_table.to_polars(self)

    def to_pandas(self) -> "pandas.DataFrame":
        """Return the track table as a pandas data frame, numbers not rounded.

        Raises OutputError if pandas is not installed.
        """
        return track_table.to_pandas(self)

    def plot(
        self, ax: "Axes | None" = None, *, fixes: "Sequence[PositionFix]" = (), truth_m: Array | None = None
    ) -> "Axes":
        """Draw the track of every device with 95 % ellipses.

        Parameters
        ----------
        ax
            Matplotlib axes to draw into; new ones by default.
        fixes
            Position fixes, drawn as diamonds.
        truth_m
            (k, 2) true positions in the frame of the track, m, drawn as a dashed line.

        Returns
        -------
        matplotlib.axes.Axes
            The axes, with equal scales.
        """
        from pdr_est.types.track_output.drawing import plot_track_on

        return plot_track_on(ax, self, fixes, truth_m)


def bracketing_poses(
    time_s: Array, moving_from_s: Array, at_s: Array
) -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
    """Find the poses before and after each time, and the fraction of the way between them.

    Parameters
    ----------
    time_s, moving_from_s
        (n,) s, of the poses of one device. The walker stands until the next movement begins, before the first pose
        and after the last one.
    at_s
        (k,) s, times to look up.

    Returns
    -------
    before, after : NDArray[np.int64]
        (k,) indices of poses.
    share : Array
        (k,) fraction of the way from `before` to `after`, 0 to 1.
    """
    after = np.clip(np.searchsorted(time_s, at_s, side="right"), 1, max(len(time_s) - 1, 1))
    if len(time_s) == 1:
        after = np.zeros(len(at_s), dtype=np.int64)
    before = np.maximum(after - 1, 0)
    begin = np.maximum(moving_from_s[after], time_s[before])
    span = np.maximum(time_s[after] - begin, 1e-9)
    return before, after, np.clip((at_s - begin) / span, 0.0, 1.0)


def concatenate(tracks: Sequence[Track]) -> Track:
    """Join the tracks of several devices, their regions and findings; other properties are those of the first track.

    If any of the tracks has a region, those without it get the region of their positions and covariances.
    """
    columns: dict[str, Any] = {
        name: np.concatenate([getattr(track, name) for track in tracks]) for name in _POSE_FIELDS
    }
    findings = tuple(dict.fromkeys(finding for track in tracks for finding in track.findings))
    regions = [
        track.region or PoseRegion.of_gaussians(track.position_m, track.covariance_m2)
        for track in tracks
        if any(one.region is not None for one in tracks)
    ]
    return replace(tracks[0], **columns, findings=findings, region=joined_regions(regions) if regions else None)
