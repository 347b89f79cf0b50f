"""Names that recorders give to sensors, in several languages, joined without separators, case and accents.

A name that is absent here can still be given in a mapping file. Names of one letter are those of physics: a
acceleration, w (omega) rotation rate, m and B magnetic field.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from pdr_est.io.tables.quantities import Quantity


@dataclass(frozen=True)
class Word:
    """Meaning of one name.

    Attributes
    ----------
    quantity
        The quantity that the name means.
    rank
        Preference among names of the same quantity in one table, lowest first.
    ambiguous
        True where the name is also used for another quantity.
    apple
        True for a name of Core Motion, which implies Apple's sign.
    """

    quantity: Quantity
    rank: int = 1
    ambiguous: bool = False
    apple: bool = False


def _words(text: str, word: Word) -> dict[str, Word]:
    return dict.fromkeys(text.split(), word)


SENSORS: Mapping[str, Word] = {
    # Accelerometer: first the names that promise gravity.
    **_words(
        "gf gforce accelerationincludinggravity accincludinggravity accelerationwithgravity", Word(Quantity.FORCE, 0)
    ),
    **_words("totalacceleration totalacc gforces accwithgravity accgravityincluded", Word(Quantity.FORCE, 0)),
    **_words("accelerometeracceleration", Word(Quantity.FORCE, 0, apple=True)),
    **_words(
        "acc acce accel accelerometer accelerometers accl accele acelerometro accelerometre", Word(Quantity.FORCE)
    ),
    **_words(
        "beschleunigungssensor beschleunigungsmesser 加速度计 加速度計 加速度传感器 加速度センサ",
        Word(Quantity.FORCE),
    ),
    **_words("加速度センサー 加速计 加速度传感器 accelerometro akzelerometer specificforce", Word(Quantity.FORCE)),
    **_words("typeaccelerometer accelerometersensor accdata acceleratormeter", Word(Quantity.FORCE)),
    **_words(
        "acceleration accelerations beschleunigung aceleracion accelerazione 加速度", Word(Quantity.FORCE, 2, True)
    ),
    **_words("a arss acclin", Word(Quantity.FORCE, 2, True)),
    **_words(
        "uncalaccel accelerometeruncalibrated acceleroemteruncalibrated uncalibratedaccelerometer",
        Word(Quantity.FORCE, 4),
    ),
    **_words(
        "accuncalibrated rawaccelerometer accraw accelraw typeaccelerometeruncalibrated", Word(Quantity.FORCE, 4)
    ),
    # Acceleration without gravity; ROS and some devices call what includes it "linear", so that the values decide.
    **_words(
        "linearacceleration linacc linearacc linaccel linacceleration linearaccel linacce",
        Word(Quantity.LINEAR, 2, True),
    ),
    **_words(
        "linearaccelerometer lineareaccelerometer accelerometerlinear accelerationlinear accelerometrelineaire",
        Word(Quantity.LINEAR, 2, True),
    ),
    **_words(
        "acclinear accellinear linear lin accelerationwithoutgravity accelerationwithoutg accwithoutgravity typelinearacceleration",
        Word(Quantity.LINEAR, 2, True),
    ),
    **_words(
        "linearebeschleunigung lineareacceleration aceleracionlineal accelerationlineaire",
        Word(Quantity.LINEAR, 2, True),
    ),
    **_words(
        "线性加速度 線形加速度 线性加速度传感器 線性加速度 线加速度 線形加速度センサー",
        Word(Quantity.LINEAR, 2, True),
    ),
    **_words(
        "useracceleration accelerationuser motionuseracceleration useracc useraccel uacc",
        Word(Quantity.LINEAR, 1, apple=True),
    ),
    **_words("benutzerbeschleunigung 用户加速度 ユーザー加速度 ユーザ加速度", Word(Quantity.LINEAR, 1)),
    # Gravity
    **_words(
        "gravity grav motiongravity gravityacceleration gravityvector gravitysensor schwerkraft",
        Word(Quantity.GRAVITY),
    ),
    **_words(
        "typegravity gravedad gravite gravita gravitation erdanziehung 重力 重力加速度 重力传感器 重力センサー",
        Word(Quantity.GRAVITY),
    ),
    # Gyroscope
    **_words(
        "gyr gyro gyroscope gyroscopes gyroscop giroscopio giroscope gyroskop kreisel gyrorotation",
        Word(Quantity.RATE),
    ),
    **_words(
        "rotationrate motionrotationrate rotrate gyrorate drehrate drehgeschwindigkeit angularvelocity",
        Word(Quantity.RATE),
    ),
    **_words(
        "angularrate angvel angvelocity angularvel angrate angularspeed winkelgeschwindigkeit omega",
        Word(Quantity.RATE),
    ),
    **_words(
        "velocidadangular vitesseangulaire vitesserotation velocitaangolare typegyroscope gyrodata",
        Word(Quantity.RATE),
    ),
    **_words(
        "陀螺仪 陀螺儀 角速度 ジャイロ ジャイロスコープ ジャイロセンサー 陀螺 角速度传感器 ジャイロセンサ",
        Word(Quantity.RATE),
    ),
    **_words("w wrss rate angular ang", Word(Quantity.RATE, 2)),
    **_words(
        "uncalgyro gyroscopeuncalibrated gyrouncalibrated uncalibratedgyroscope gyroraw rawgyroscope rawgyro",
        Word(Quantity.RATE, 4),
    ),
    **_words("typegyroscopeuncalibrated unbiasedrotationrate", Word(Quantity.RATE, 4)),
    **_words("g", Word(Quantity.RATE, 3, True)),
    # Magnetometer
    **_words(
        "mag magn magnet magneto magnetometer magnetometers magneticfield motionmagneticfield", Word(Quantity.FIELD)
    ),
    **_words(
        "magnetfeld magnetfeldsensor magnetometro magnetometre campomagnetico champmagnetique compass",
        Word(Quantity.FIELD),
    ),
    **_words(
        "typemagneticfield magneticflux magfield magneticfieldsensor geomagneticfield b m", Word(Quantity.FIELD)
    ),
    **_words("磁力计 磁場 磁场 磁気 地磁気 磁力計 磁气 地磁 磁気センサー 磁场传感器", Word(Quantity.FIELD)),
    **_words(
        "uncalmag magnetometeruncalibrated maguncalibrated uncalibratedmagnetometer rawmagnetometer",
        Word(Quantity.FIELD, 4),
    ),
    # Attitude; without a w the same names hold a rotation vector, or angles, which the values tell.
    **_words("q quat quaternion motionquaternion attitudequaternion orientationquaternion", Word(Quantity.ATTITUDE)),
    **_words("attitude quaternions quater cuaternion 四元数 クォータニオン", Word(Quantity.ATTITUDE)),
    **_words(
        "rotationvector rotvec rv typerotationvector rotv rotationsvektor 旋转矢量 回転ベクトル",
        Word(Quantity.ROTATION_VECTOR),
    ),
    **_words("orientation orient", Word(Quantity.ROTATION_VECTOR, 2, True)),
    **_words("gamerotationvector gamerv gamerotvec typegamerotationvector", Word(Quantity.ROTATION_VECTOR, 3)),
}
"""Names of sensors with axes."""

SCALARS: Mapping[str, tuple[Quantity, str, int]] = {
    **dict.fromkeys(
        "press pressure barometer baro altimeterpressure atmosphericpressure airpressure luftdruck druck "
        "气压 氣壓 気圧 大气压 presion presionatmosferica pression pressionatmospherique typepressure 压力".split(),
        (Quantity.PRESSURE, "", 1),
    ),
    **dict.fromkeys(
        "latitude lat locationlatitude gpslatitude gpslat latitudedegrees latitud breitengrad breite geobreite "
        "latitudine 纬度 緯度".split(),
        (Quantity.LATITUDE_LONGITUDE, "latitude", 1),
    ),
    **dict.fromkeys(
        "longitude lng lon long locationlongitude gpslongitude gpslon gpslng longitudedegrees longitud langengrad "
        "lange laengengrad geolange longitudine 经度 経度 經度".split(),
        (Quantity.LATITUDE_LONGITUDE, "longitude", 1),
    ),
    **dict.fromkeys(
        "horizontalaccuracy locationhorizontalaccuracy locationaccuracy gpsaccuracy accuracymeters hacc "
        "gpshorizontalaccuracy horizontalegenauigkeit genauigkeit precisionhorizontal 水平精度 精度 hdopm".split(),
        (Quantity.ACCURACY, "", 1),
    ),
}
"""Names of columns that have no axis: quantity, part, rank."""

TIMES = frozenset(
    "time timestamp timestamps t ts zeit zeitstempel uhrzeit date datetime dateandtime datum datumzeit clock fecha "
    "hora tiempo marcatemporal marcadetiempo marcadeltiempo temps heure horodatage 时间 時間 时间戳 時刻 時間戳 タイムスタンプ 日時 "
    "日期 日期时间 tempo ora data epoch epoc unixtime unix unixtimestamp utc gpstime loggingtime localtime systemtime "
    "sampletime sampletimefine eventtime sensortime devicetime boottime elapsedtime elapsed timeelapsed uptime "
    "secondselapsed timesincestart timeelapsedsincestart elapsedrealtime sincestart stamp laufzeit zeitpunkt "
    "timemillis timenanos utctime utctimemillis elapsedrealtimenanos unixtimemillis currenttimemillis systemtimemillis "
    "abgelaufenezeit verstrichenezeit tiempotranscurrido tempsecoule 经过时间 経過時間 timeinms timesincestartinms "
    "yyyymoddhhmiss yyyymmddhhmmss yyyymoddhhmisssss".split()
)
"""Names of columns with the time."""

TIME_TOKENS = frozenset(
    "time timestamp timestamps stamp clock datetime date elapsed epoch zeit uhrzeit 时间 時間 时间戳 時刻 loggingtime "
    "millis nanos milliseconds nanoseconds microseconds millisecond seconds secs nsecs sec nsec nanosec "
    "sekunden millisekunden nanosekunden segundos milisegundos secondes millisecondes 毫秒 纳秒 秒 ミリ秒".split()
)
"""Single words by which a longer title is recognised as a time, too."""

FILLERS = frozenset(
    "axis axes achse axe eje asse 轴 軸 raw data value values val sensor sensors imu component calibrated cal si wert "
    "werte reading readings measurement ios android phone device core motion body frame field values0 方向 軸方向 轴向 "
    "richtung of the in de der du del rs s en des".split()
)
"""Words of a title that carry no meaning here."""

BLOCKED = frozenset(
    "angular angulaire winkel bias biases std stdev var variance sigma mean avg average min max delta diff difference error err offset noise "
    "cov covariance jerk norm abs absolute magnitude magnitud rms angularacceleration filtered lowpass highpass fft "
    "power energy velocity speed position pos displacement distance status altitude height course heading step steps "
    "temperature temp count counter battery true truth ref reference gt groundtruth rate_hz frequency freq".split()
)
"""Words that make a title mean something else than the sensor that it also names."""

AXIS_WORDS: Mapping[str, str] = {
    "x": "x",
    "y": "y",
    "z": "z",
    "w": "w",
    "cos": "w",
    "0": "0",
    "1": "1",
    "2": "2",
    "3": "3",
}
"""Words of a title that name an axis; digits count components."""

BROWSER_ANGLES: Mapping[str, str] = {"alpha": "z", "beta": "x", "gamma": "y"}
"""Axes of `rotationRate` in a browser's DeviceMotion event."""
