"""Names of units in every spelling, and how a unit is brought to one way of writing before it is looked up.

`m/s²`, `m s^-2`, `meters per second squared`, `米/秒²` and `m/s/s` are one unit. `plain_unit` takes away what only
writing adds: case, blanks, dots, brackets, powers as signs, and words for a part of the unit. `SPELLINGS` has what
is left then.
"""

import re
from collections.abc import Mapping

from pdr_est.io.tables.words.folding import folded

_SIGNS = str.maketrans(
    {"µ": "u", "μ": "u", "º": "°", "∕": "/", "⁄": "/", "／": "/", "÷": "/", "−": "-", "–": "-", "⋅": ".", "∙": "."}
)
_PARTS: Mapping[str, str] = {
    word: sign
    for sign, words in {
        "m": "meter meters metre metres metro metros metri metr metry метр метра м 米 メートル 미터",
        "s": "sec secs second seconds sekunde sekunden segundo segundos seconde secondes secondo secondi seg "
        "seconden sekunda sekundy с сек секунда секунду 秒 초",
        "rad": "radian radians radiant radianti radianes radiante radiaal радиан рад 弧度 ラジアン 라디안",
        "deg": "degree degrees grad grado grados gradi graden degre degres graus grau ° градус градусов 度 도",
        "/": "per pro par por в 毎 每",
        "2": "squared square quadrat sq cuadrado carre quadrato ao quadrado kwadraat kwadrat",
        "m/s2": "米每二次方秒 米每平方秒 メートル毎秒毎秒 米秒平方",
        "rad/s": "弧度每秒 弧度秒 ラジアン毎秒",
        "deg/s": "度每秒 度毎秒",
    }.items()
    for word in words.split()
}
_WORD = re.compile(r"[^\W\d_]+|°")
_DROPPED = re.compile(r"[\s^*·×.'’`\"(){}\[\]]|_")

TIME_SPELLINGS: Mapping[str, str] = {
    "s": "sekunden 秒",
    "ms": "msec msecs millis milli millisecond milliseconds millisekunden milisegundos millisecondes 毫秒 ミリ秒 мс",
    "us": "usec usecs micros microsecond microseconds mikrosekunden microsegundos 微秒 マイクロ秒 мкс",
    "ns": "nsec nsecs nanos nano nanosecond nanoseconds nanosekunden nanosegundos 纳秒 奈秒 ナノ秒 нс",
    "100ns": "",
    "min": "mins minute minutes minuten minutos minuti мин 分 分钟 分鐘 분",
    "h": "hr hrs hour hours stunde stunden horas heures ore 小时 小時",
}
"""Usual name of each unit of time -> other spellings, as `plain_unit` writes them."""

ACCELERATION_SPELLINGS: Mapping[str, str] = {
    "m/s^2": "m/s/s m/ss m/2s ms-2 mps2 ms2 mpss mpersec2 mpers2 mss m/s2/s",
    "g": "gs gn g0 gforce g-force gee gees",
    "mg": "milli-g millig mgs mgn",
    "cm/s^2": "cms-2 cmps2 cms2 gal",
    "mm/s^2": "mms-2 mmps2 mms2",
    "ft/s^2": "fts-2 feet/s2",
    "ug": "microg micro-g",
}
"""The same of accelerations."""

RATE_SPELLINGS: Mapping[str, str] = {
    "rad/s": "rads-1 radps rads rads/s radpersec radpers 1/s s-1",
    "deg/s": "degs-1 degps degs degs/s degpersec dps deg/s1",
    "mdeg/s": "mdps mdegps mdegs-1 millidps millideg/s milli-dps",
    "mrad/s": "mradps mrads-1 millirad/s",
    "rpm": "r/min rev/min u/min revolutions/minute 1/min",
    "rev/s": "revs/s turns/s u/s revolutions/s",
}
"""The same of rotation rates."""

FIELD_SPELLINGS: Mapping[str, str] = {
    "uT": "microtesla microt mikrotesla microteslas 微特斯拉 マイクロテスラ мктл",
    "nT": "nanotesla nanoteslas",
    "mT": "millitesla milliteslas",
    "T": "tesla teslas",
    "gauss": "g gs gss",
    "mgauss": "mg milligauss mgs",
}
"""The same of magnetic fields."""

PRESSURE_SPELLINGS: Mapping[str, str] = {
    "Pa": "pascal",
    "hPa": "hectopascal hektopascal",
    "kPa": "kilopascal",
    "mbar": "mb mbars millibar millibars",
    "bar": "",
}
"""The same of air pressures."""

LENGTH_SPELLINGS: Mapping[str, str] = {"m": "", "cm": "", "mm": "", "km": "", "ft": "feet foot"}
"""The same of lengths."""

WITHOUT_MEANING = frozenset(
    {
        *("", "-", "--", "1", "none", "null", "na", "n/a", "nounits", "nounit", "unitless", "dimensionless"),
        *("txt", "text", "string", "str", "bool", "boolean", "int", "integer", "float", "double", "number", "char"),
        *("deg", "rad", "degc", "°c", "c", "celsius", "k", "f", "%", "percent", "lux", "lx", "cm", "n", "v", "mv"),
        *("m/s", "km/h", "mps", "mph", "bpm", "hz", "db", "dbm", "count", "counts", "lsb", "iso8601"),
    }
)
"""What stands in a row of units beside the units that are used here, as `plain_unit` writes it."""


def plain_unit(unit: str) -> str:
    """Write a unit in one way: lower case, without blanks and brackets, `2` for squared, `u` for micro."""
    plain = folded(folded(unit.strip().translate(_SIGNS)).translate(_SIGNS))
    return _DROPPED.sub("", _WORD.sub(lambda match: _PARTS.get(match[0], match[0]), plain))
