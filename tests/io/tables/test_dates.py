"""Dates and times of day in the forms of recorders."""

import numpy as np
import pytest

from pdr_est.io.tables.times.dates import parse_dates

MOMENT = np.datetime64("2031-02-13T04:05:06.789", "ns").astype(np.int64)


@pytest.mark.parametrize(
    "text",
    [
        "2031-02-13 04:05:06.789",
        "2031-02-13T04:05:06,789",
        "2031-02-13 4:05:06.7890",
        "2031-02-13 04:05:06:789",
        "2031/02/13 04:05:06.789",
        "13.02.2031 04:05:06.789",
        "13-02-2031 04:05:06.789",
        "13/2/2031, 04:05:06.789",
        "2/13/2031 4:05:06.789 AM",
        "13-Feb-2031 04:05:06.789",
        "13-feb.-2031 04:05:06.789",
        "20310213_040506_789",
        "20310213T040506.789",
        "2031年2月13日 04:05:06.789",
    ],
)
def test_dates_in_any_form(text: str) -> None:
    found = parse_dates(np.array([text, text]))
    assert found is not None
    assert found.ns.tolist() == [MOMENT, MOMENT]
    assert (found.has_date, found.has_zone, found.known.all()) == (True, False, True)


@pytest.mark.parametrize("zone", ["Z", " UTC", "+00:00", "-0000"])
def test_a_zone_gives_unix_time(zone: str) -> None:
    found = parse_dates(np.array([f"2031-02-13T04:05:06.789{zone}", "2031-02-13T06:35:06.789+02:30"]))
    assert found is not None
    assert found.has_zone
    assert found.ns.tolist() == [MOMENT, MOMENT]


def test_a_date_with_the_name_of_the_day() -> None:
    found = parse_dates(np.array(["Thu Feb 13 05:05:06 GMT+01:00 2031"]))
    assert found is not None
    assert found.ns.tolist() == [MOMENT - 789_000_000]


def test_milliseconds_without_zeros_in_front() -> None:
    found = parse_dates(np.array(["2031-02-13 04:05:06:9", "2031-02-13 04:05:06:19"]))
    assert found is not None
    assert np.diff(found.ns).tolist() == [10_000_000]


@pytest.mark.parametrize(
    ("texts", "steps_s"),
    [
        (["23:59:59.9", "0:00:00.1", "00:00:00.3"], [0.2, 0.2]),
        (["11:59:59 AM", "12:00:01 PM", "1:00:00 PM"], [2.0, 3599.0]),
        (["59:58.5", "00:01.0"], [2.5]),
    ],
)
def test_times_of_day_go_on_over_midnight_and_noon(texts: list[str], steps_s: list[float]) -> None:
    found = parse_dates(np.array(texts))
    assert found is not None
    assert not found.has_date
    np.testing.assert_allclose(np.diff(found.ns) / 1e9, steps_s)


def test_a_cell_that_is_no_date_among_others() -> None:
    texts = ["2031-02-13 04:05:06.789"] * 30
    texts[3], texts[7], texts[9] = "2031-02-13 04:65:06", "", "2031-13-02 04:05:06"
    found = parse_dates(np.array(texts))
    assert found is not None
    assert np.flatnonzero(~found.known).tolist() == [3, 7, 9]


@pytest.mark.parametrize(
    ("texts", "order", "day"),
    [
        (["03/02/2031 04:05:06"], "day", "2031-02-03"),
        (["3-2-31 04:05:06"], "day", "2031-02-03"),
        (["03/02/2031 4:05:06 AM"], "month", "2031-03-02"),
        (["03/02/2031 04:05:06", "13/02/2031 04:05:06"], "", "2031-02-03"),
        (["03/02/2031 04:05:06", "02/13/2031 04:05:06"], "", "2031-03-02"),
        (["03.02.2031 04:05:06"], "", "2031-02-03"),
        (["03-Feb-2031 04:05:06"], "", "2031-02-03"),
        (["02/02/2031 04:05:06"], "", "2031-02-02"),
        (["2031/03/02 04:05:06"], "", "2031-03-02"),
    ],
)
def test_an_open_order_of_day_and_month_is_told(texts: list[str], order: str, day: str) -> None:
    found = parse_dates(np.array(texts))
    assert found is not None
    assert found.order == order
    assert found.ns[0] == np.datetime64(f"{day}T04:05:06", "ns").astype(np.int64)


@pytest.mark.parametrize("text", ["31.02.2031 04:05:06", "2031-02-29 04:05:06", "2031-04-31 04:05:06"])
def test_a_day_that_the_month_does_not_have(text: str) -> None:
    found = parse_dates(np.array([text, "2032-02-29 04:05:06" if text[4] == "-" else "29.02.2032 04:05:06"]))
    assert found is not None
    assert found.known.tolist() == [False, True]


def test_a_date_without_a_zone_among_others_is_not_known() -> None:
    found = parse_dates(np.array(["2031-02-13T04:05:06.789Z", "2031-02-13T04:05:07"]))
    assert found is not None
    assert found.has_zone
    assert found.known.tolist() == [True, False]


def test_texts_that_are_no_dates() -> None:
    assert parse_dates(np.array(["walking", "2031", "1.5", "x:y:z"])) is None
    assert parse_dates(np.array(["", ""])) is None


@pytest.mark.parametrize(
    ("places", "mark", "counted"), [(3, ".", "ms"), (3, ":", "ms"), (6, ".", "us"), (6, ":", "us"), (9, ",", "ns")]
)
def test_digits_without_zeros_in_front_count_parts_of_a_second(places: int, mark: str, counted: str) -> None:
    ns = MOMENT + 20_000_000 * np.arange(300)
    parts = [
        (str(stamp)[:19], int(at) % 10**9 // 10 ** (9 - places)) for at, stamp in zip(ns, stamps(ns), strict=True)
    ]
    found = parse_dates(np.array([f"{second}{mark}{fraction}" for second, fraction in parts]))
    assert found is not None
    assert found.ns.tolist() == ns.tolist()
    assert found.counted == counted
    unpadded = [f"{second[11:].replace(':0', ':').removeprefix('0')}{mark}{fraction}" for second, fraction in parts]
    found = parse_dates(np.array(unpadded))
    assert found is not None
    assert np.unique(np.diff(found.ns)).tolist() == [20_000_000]


def test_decimals_without_zeros_behind_stay_decimals() -> None:
    ns = MOMENT + 20_000_000 * np.arange(300) - 789_000_000
    found = parse_dates(np.array([str(stamp).rstrip("0").rstrip(".") for stamp in stamps(ns)]))
    assert found is not None
    assert found.ns.tolist() == ns.tolist()
    assert found.counted == ""


def stamps(ns: np.ndarray) -> list[np.datetime64]:
    return list(ns.astype("datetime64[ns]"))


@pytest.mark.parametrize(
    "text",
    [
        "2031年2月13日 12时05分06秒",
        "2031年02月13日12時05分06.000秒",
        "2031年2月13日 下午12:05:06",
        "2031年2月13日（木） 12時5分6秒",
        "2031年2月13日 12：05：06",
        "2031/2/13 下午12:05:06",
        "2031년 2월 13일 오후 12시 5분 6초",
        "13. Februar 2031 12:05:06",
        "13 févr. 2031 12:05:06",
        "13 de febrero de 2031 12:05:06",
        "Feb 13, 2031 12:05:06 PM",
        "13-févr.-2031 12:05:06",
    ],
)
def test_dates_in_other_languages(text: str) -> None:
    found = parse_dates(np.array([text, text]))
    assert found is not None
    assert found.ns.tolist() == [np.datetime64("2031-02-13T12:05:06", "ns").astype(np.int64)] * 2
    assert found.has_date


def test_times_of_day_in_chinese() -> None:
    found = parse_dates(np.array(["4时05分06秒789毫秒", "4时05分07秒009毫秒"]))
    assert found is not None
    assert np.diff(found.ns).tolist() == [220_000_000]


@pytest.mark.parametrize("day", ["", "2031-02-03 "])
def test_a_clock_to_12_without_am_and_pm_goes_on_after_12(day: str) -> None:
    texts = [f"{day}{text}" for text in ("12:59:59.500", "01:00:00.000", "01:00:00.500")]
    dates = parse_dates(np.array(texts))
    assert dates is not None
    np.testing.assert_array_equal(np.diff(dates.ns) / 1e9, [0.5, 0.5])


def test_a_clock_that_starts_again_at_one_is_no_clock_to_12() -> None:
    dates = parse_dates(np.array(["00:10:00.0", "12:59:59.0", "01:00:00.0"]))
    assert dates is not None
    assert np.diff(dates.ns)[1] < 0
