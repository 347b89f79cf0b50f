"""Names of columns without axes, names of axes, and words that carry no meaning or change it."""

from collections.abc import Mapping

from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.tables.words.folding import folded, split_words


def _names(text: str) -> frozenset[str]:
    """Names that are compared with the joined words of a title."""
    return frozenset("".join(split_words(name)) for name in text.split())


def _words(text: str) -> frozenset[str]:
    """Words that are compared with single words of a title."""
    return frozenset(map(folded, text.split()))


PRESSURES = _names(
    """press pressure barometer baro altimeterpressure atmosphericpressure airpressure typepressure luftdruck druck
    presion presionatmosferica pression pressionatmospherique pressione pressioneatmosferica pressao
    pressaoatmosferica luchtdruk ciśnienie давление барометр 气压 氣壓 気圧 大气压 压力 气压计 기압 기압계"""
)
"""Names of columns with the air pressure."""

LATITUDES = _names(
    """latitude lat locationlatitude gpslatitude gpslat latitudedegrees latitud breitengrad breite geobreite
    latitudine breedtegraad szerokość широта 纬度 緯度 위도"""
)
"""Names of columns with the latitude."""

LONGITUDES = _names(
    """longitude lng lon long locationlongitude gpslongitude gpslon gpslng longitudedegrees longitud langengrad
    lange laengengrad geolange longitudine lengtegraad długość долгота 经度 経度 經度 경도"""
)
"""Names of columns with the longitude."""

ACCURACIES = _names(
    """horizontalaccuracy locationhorizontalaccuracy locationaccuracy gpsaccuracy gpshorizontalaccuracy
    accuracymeters hacc horizontalegenauigkeit precisionhorizontal 水平精度"""
)
"""Names of columns with the accuracy of a position."""

EASTINGS = _names("x east easting xpos posx positionx xcoordinate xcoord e ost est este oost восток 东 東 동")
"""Names of columns with the position to the east, in a table of positions."""

NORTHINGS = _names("y north northing ypos posy positiony ycoordinate ycoord n nord norte noord север 北 북")
"""Names of columns with the position to the north, in a table of positions."""

SCALARS: Mapping[str, tuple[Quantity, str]] = {
    **dict.fromkeys(PRESSURES, (Quantity.PRESSURE, "")),
    **dict.fromkeys(LATITUDES, (Quantity.LATITUDE_LONGITUDE, "latitude")),
    **dict.fromkeys(LONGITUDES, (Quantity.LATITUDE_LONGITUDE, "longitude")),
    **dict.fromkeys(ACCURACIES, (Quantity.ACCURACY, "")),
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
    temps heure horodatage tempsecoule tempo ora data orario datahora tempodecorrido tempotrascorso marcadetempo
    tijd tijdstempel tijdstip datumtijd verstrekentijd czas znacznikczasu godzina tid tidsstampel tidspunkt zaman
    čas waktu aika время времяс отметкавремени дата датаивремя час χρόνος
    시간 시각 타임스탬프 경과시간 日付 计时 時間秒
    时间 時間 时间戳 時間戳 日期 日期时间 经过时间 時刻 日時 経過時間 タイムスタンプ"""
)
"""Names of columns with the time."""

TIME_WORDS = _words(
    """time timestamp timestamps stamp clock datetime date elapsed epoch zeit uhrzeit loggingtime
    ms us ns millis micros nanos millisecond milliseconds microseconds nanoseconds seconds secs nsecs sec nsec nanosec
    sekunden millisekunden nanosekunden segundos milisegundos secondes millisecondes secondi millisecondi
    tempo temps tiempo tijd czas tid время 시간 타임스탬프 タイムスタンプ
    时间 時間 时间戳 時刻 秒 毫秒 纳秒 ミリ秒"""
)
"""Single words by which a longer title is recognised as a time, too."""

FILLERS = _words(
    """axis axes achse axe eje asse eixo as os oś ось axel direction richtung direccion component komponente
    xyz vector vehicle attr raw uncal
    uncalib uncalibrated data value values val reading readings measurement sensor sensors imu calibrated
    cal si wert werte ios android phone device core motion body frame field of the in de der du del rs s en des di
    del do da van od wzdłuż по le la lungo along about around um 轴 軸 方向 軸方向 轴向 축"""
)
"""Words of a title that carry no meaning."""

BLOCKED = _words(
    """angular angulaire winkel bias biases drift drifts std stdev var variance sigma mean avg average min max delta
    diff difference error err offset noise cov covariance jerk norm abs absolute magnitude magnitud rms filtered
    lowpass highpass fft power energy velocity speed position pos displacement distance status
    altitude height course heading step steps
    temperature temp count counter battery true truth ref reference gt groundtruth frequency freq"""
)
"""Words beside the name of a sensor that make a title mean something else."""

AXIS_WORDS: Mapping[str, str] = {
    **{axis: axis for axis in ("x", "y", "z", "w", "0", "1", "2", "3")},
    "cos": "w",
    "х": "x",  # Cyrillic
    "у": "y",
}
"""Words of a title that name an axis; digits count components."""

BROWSER_ANGLES: Mapping[str, str] = {"alpha": "z", "beta": "x", "gamma": "y"}
"""Axes of `rotationRate` in a browser's DeviceMotion event."""

TURNED_AXES: Mapping[str, str] = {
    "pitch": "x", "nick": "x", "roll": "y", "yaw": "z", "azimuth": "z", "gier": "z",
}  # fmt: skip
"""Axes of a rotation rate that is named by the angle that it changes, in the order of Android and Apple."""
