"""Names of columns without axes, names of axes, and words that carry no meaning or change it."""

from collections.abc import Mapping

from pdr_est.io.tables.quantities import Quantity


def _names(text: str) -> frozenset[str]:
    return frozenset(text.split())


_PRESSURE = _names(
    """press pressure barometer baro altimeterpressure atmosphericpressure airpressure typepressure luftdruck druck
    presion presionatmosferica pression pressionatmospherique 气压 氣壓 気圧 大气压 压力"""
)
_LATITUDE = _names(
    """latitude lat locationlatitude gpslatitude gpslat latitudedegrees latitud breitengrad breite geobreite
    latitudine 纬度 緯度"""
)
_LONGITUDE = _names(
    """longitude lng lon long locationlongitude gpslongitude gpslon gpslng longitudedegrees longitud langengrad
    lange laengengrad geolange longitudine 经度 経度 經度"""
)
_ACCURACY = _names(
    """horizontalaccuracy locationhorizontalaccuracy locationaccuracy gpsaccuracy gpshorizontalaccuracy
    accuracymeters hacc horizontalegenauigkeit precisionhorizontal 水平精度"""
)

SCALARS: Mapping[str, tuple[Quantity, str]] = {
    **dict.fromkeys(_PRESSURE, (Quantity.PRESSURE, "")),
    **dict.fromkeys(_LATITUDE, (Quantity.LATITUDE_LONGITUDE, "latitude")),
    **dict.fromkeys(_LONGITUDE, (Quantity.LATITUDE_LONGITUDE, "longitude")),
    **dict.fromkeys(_ACCURACY, (Quantity.ACCURACY, "")),
}
"""Name -> quantity and the part of it."""

TIMES = _names(
    """time timestamp timestamps t ts date datetime dateandtime clock epoch epoc unix unixtime unixtimestamp utc
    utctime gpstime loggingtime localtime systemtime sampletime sampletimefine eventtime sensortime devicetime
    boottime elapsed elapsedtime timeelapsed secondselapsed timesincestart sincestart
    timeelapsedsincestart elapsedrealtime uptime
    stamp timemillis timenanos utctimemillis elapsedrealtimenanos unixtimemillis currenttimemillis
    systemtimemillis timeinms timesincestartinms recordedat createdat measuredat sampledat
    receivedat timeofday yyyymoddhhmiss yyyymmddhhmmss yyyymoddhhmisssss
    zeit zeitstempel uhrzeit datum datumzeit laufzeit zeitpunkt abgelaufenezeit verstrichenezeit
    fecha hora fechahora tiempo marcatemporal marcadetiempo marcadeltiempo tiempotranscurrido
    temps heure horodatage tempsecoule tempo ora data
    时间 時間 时间戳 時間戳 日期 日期时间 经过时间 時刻 日時 経過時間 タイムスタンプ"""
)
"""Names of columns with the time."""

TIME_WORDS = _names(
    """time timestamp timestamps stamp clock datetime date elapsed epoch zeit uhrzeit loggingtime
    ms us ns millis micros nanos millisecond milliseconds microseconds nanoseconds seconds secs nsecs sec nsec nanosec
    sekunden millisekunden nanosekunden segundos milisegundos secondes millisecondes
    时间 時間 时间戳 時刻 秒 毫秒 纳秒 ミリ秒"""
)
"""Single words by which a longer title is recognised as a time, too."""

FILLERS = _names(
    """axis axes achse axe eje asse direction richtung component raw data value values val reading readings
    measurement sensor sensors imu calibrated cal si wert werte ios android phone device core motion body frame field
    of the in de der du del rs s en des attr 轴 軸 方向 軸方向 轴向"""
)
"""Words of a title that carry no meaning."""

BLOCKED = _names(
    """angular angulaire winkel bias biases std stdev var variance sigma mean avg average min max delta diff
    difference error err offset noise cov covariance jerk norm abs absolute magnitude magnitud rms filtered
    lowpass highpass fft power energy velocity speed position pos displacement distance status
    altitude height course heading step steps
    temperature temp count counter battery true truth ref reference gt groundtruth frequency freq"""
)
"""Words beside the name of a sensor that make a title mean something else."""

AXIS_WORDS: Mapping[str, str] = {
    **{axis: axis for axis in ("x", "y", "z", "w", "0", "1", "2", "3")},
    "cos": "w",
}
"""Words of a title that name an axis; digits count components."""

BROWSER_ANGLES: Mapping[str, str] = {"alpha": "z", "beta": "x", "gamma": "y"}
"""Axes of `rotationRate` in a browser's DeviceMotion event."""
