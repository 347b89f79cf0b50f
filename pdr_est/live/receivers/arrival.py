"""Clock of a phone beside that of this computer: what arrives cannot be from the future, nor from long ago."""

_AGREEMENT_S = 2.0  # phones set their clocks by the network, to far less than this


class ArrivalClock:
    """Constant that brings the times of one phone to the clock of the walk, found when its first samples arrive.

    A phone whose clock agrees with that of this computer to two seconds keeps its own time: its stamps are more even
    than arrivals are, and two phones that are set by the network agree better than their arrivals. The times of any
    other phone are shifted so that its first samples end when they arrive.

    Parameters
    ----------
    always
        True for times that count from an arbitrary moment.
    """

    def __init__(self, always: bool = False) -> None:
        self._always = always
        self.shift_s: float | None = None
        self.ahead_s = 0.0

    def to_walk(self, newest_s: float, now_s: float) -> float:
        """Return the constant to add to the times of the phone, s.

        Parameters
        ----------
        newest_s
            Newest time among samples that have just arrived, on the phone's own clock, s.
        now_s
            Present time of the walk, s.
        """
        if self.shift_s is None:
            self.ahead_s = newest_s - now_s
            self.shift_s = -self.ahead_s if self._always or abs(self.ahead_s) > _AGREEMENT_S else 0.0
        return self.shift_s

    @property
    def is_wrong(self) -> bool:
        """Tell whether the phone's clock shows another time than this computer."""
        return not self._always and bool(self.shift_s)
