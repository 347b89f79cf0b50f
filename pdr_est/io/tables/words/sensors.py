"""Names of sensors with axes.

Names of one letter are those of physics: a for acceleration, w (omega) for rotation rate, m and B for magnetic field.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.tables.words.folding import split_words


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


def _named(word: Word, text: str) -> dict[str, Word]:
    return dict.fromkeys(("".join(split_words(name)) for name in text.split()), word)


_ACCELEROMETER = {
    # First the names that promise gravity.
    **_named(
        Word(Quantity.FORCE, 0),
        """gf gforce gforces accelerationincludinggravity accincludinggravity accelerationwithgravity
        accwithgravity accgravityincluded totalacceleration totalacc accelerationwithg""",
    ),
    **_named(Word(Quantity.FORCE, 0, apple=True), "accelerometeracceleration"),
    **_named(
        Word(Quantity.FORCE),
        """acc acce accl ac accel accele accelerometer accelerometers acceleratormeter accelerometro accelerometre
        acelerometro akzelerometer beschleunigungssensor beschleunigungsmesser specificforce typeaccelerometer
        accelerometersensor accdata accels accelerometerdata acceldata accelsensor acclerometer accelorometer
        acelerômetro
        acelerômetros versnellingsmeter akcelerometr accelerometern kiihtyvyysanturi ivmeölçer akselerometer
        akcelerometar
        акселерометр επιταχυνσιόμετρο 가속도계 가속도센서 加速度计 加速度計 加速计 加速度传感器 加速度感測器
        加速度センサ 加速度センサー""",
    ),
    **_named(
        Word(Quantity.FORCE, 2, ambiguous=True),
        """acceleration accelerations beschleunigung beschl accn aceleracion aceleração accelerazione versnelling
        przyspieszenie
        zrychlení ivme kiihtyvyys percepatan akselerasi acelerações akceleration akselerasjon ускорение прискорення
        επιτάχυνση giatoc 가속도 加速度 a arss acclin""",
    ),
    **_named(
        Word(Quantity.FORCE, 4),
        """uncalaccel accelerometeruncalibrated uncalibratedaccelerometer accuncalibrated rawaccelerometer accraw
        accelraw typeaccelerometeruncalibrated""",
    ),
}

# ROS and some devices call "linear" what includes gravity, so that the values decide.
_WITHOUT_GRAVITY = {
    **_named(
        Word(Quantity.LINEAR, 2, ambiguous=True),
        """la linearacceleration linacceleration linearaccel linaccel linearacc linacc linacce linearaccelerometer
        lineareaccelerometer accelerometerlinear accelerationlinear acclinear accellinear linear lin
        accelerationwithoutgravity accelerationwithoutg accwithoutgravity typelinearacceleration accelerometrelineaire
        linearebeschleunigung lineareacceleration aceleracionlineal accelerationlineaire aceleraçãolinear
        accelerazionelineare lineaireversnelling przyspieszenieliniowe линейноеускорение 선형가속도 直线加速度
        线性加速度 线性加速度传感器
        線性加速度 线加速度 線形加速度 線形加速度センサー""",
    ),
    **_named(
        Word(Quantity.LINEAR, apple=True),
        "useracceleration accelerationuser motionuseracceleration useracc useraccel uacc",
    ),
    **_named(Word(Quantity.LINEAR), "benutzerbeschleunigung 用户加速度 ユーザー加速度 ユーザ加速度"),
}

_GRAVITY = _named(
    Word(Quantity.GRAVITY),
    """gravity grav motiongravity gravityacceleration gravityvector gravitysensor typegravity schwerkraft gravitation
    erdanziehung gravedad gravite gravita gravidade zwaartekracht grawitacja гравитация 중력 重力 重力加速度
    重力传感器 重力センサー""",
)

_GYROSCOPE = {
    **_named(
        Word(Quantity.RATE),
        """gyr gyro gy gyroscope gyroscopes gyroscop giroscopio giroscope gyroskop kreisel gyrorotation rotationrate
        motionrotationrate rotrate gyrorate angularvelocity angularrate angvel angvelocity angularvel angrate
        angularspeed typegyroscope gyrodata gyros gyrosensor gyroscopesensor girosensor giro giroscópio giroscopi
        gyroscoop żyroskop gyroskooppi jiroskop giroskop żyro gyroskopet гироскоп гіроскоп γυροσκόπιο ω
        velocidadeangular hoeksnelheid prędkośćkątowa vinkelhastighet úhlovárychlost açısalhız kulmanopeus
        kecepatansudut giroscopos giróscopo 陀螺仪传感器 陀螺儀感測器 угловаяскорость скоростьвращения
        velocidadderotación velocidadderotacion rotationspeed
        rotationsgeschwindigkeit turnrate bodyrate 각속도 자이로 자이로스코프 자이로센서 回転速度 角速率 omega
        drehrate drehgeschwindigkeit winkelgeschwindigkeit
        velocidadangular vitesseangulaire vitesserotation vitessederotation velocitaangolare 陀螺仪 陀螺儀 陀螺 角速度
        角速度传感器 ジャイロ ジャイロスコープ ジャイロセンサー ジャイロセンサ""",
    ),
    **_named(Word(Quantity.RATE, 2), "w wrss rate angular ang"),
    **_named(Word(Quantity.RATE, 3, ambiguous=True), "g"),
    **_named(
        Word(Quantity.RATE, 4),
        """uncalgyro gyroscopeuncalibrated gyrouncalibrated uncalibratedgyroscope gyroraw rawgyroscope rawgyro
        typegyroscopeuncalibrated unbiasedrotationrate""",
    ),
}

_MAGNETOMETER = {
    **_named(
        Word(Quantity.FIELD),
        """mag magn magnet magneto magnetometer magnetometers magneticfield motionmagneticfield typemagneticfield
        magneticflux magfield magneticfieldsensor geomagneticfield b m magnetfeld magnetfeldsensor magnetometro
        magnetometre magnetômetro magnetometr магнитометр магнитноеполе magnetischveld polemagnetyczne 자기장 지자기
        자력계 campomagnetico champmagnetique 磁力计 磁力計 磁场 磁場 磁场传感器 磁气 磁気
        磁気センサー 地磁 地磁気""",
    ),
    **_named(
        Word(Quantity.FIELD, 4),
        "uncalmag magnetometeruncalibrated maguncalibrated uncalibratedmagnetometer rawmagnetometer",
    ),
}

# Without a w these names hold a rotation vector, or angles, which the values tell.
_ATTITUDE = {
    **_named(
        Word(Quantity.ATTITUDE),
        """q quat quaternion quaternions motionquaternion attitudequaternion orientationquaternion attitude
        cuaternion 四元数 クォータニオン""",
    ),
    **_named(
        Word(Quantity.ROTATION_VECTOR),
        "rotationvector rotvec rv rotv typerotationvector rotationsvektor 旋转矢量 回転ベクトル",
    ),
    **_named(Word(Quantity.ROTATION_VECTOR, 2, ambiguous=True), "orientation orient"),
    **_named(Word(Quantity.ROTATION_VECTOR, 3), "gamerotationvector gamerv gamerotvec typegamerotationvector"),
}

SENSORS: Mapping[str, Word] = {
    **_ACCELEROMETER,
    **_WITHOUT_GRAVITY,
    **_GRAVITY,
    **_GYROSCOPE,
    **_MAGNETOMETER,
    **_ATTITUDE,
}
"""Name -> meaning."""

ANDROID_TYPES: Mapping[int, Quantity] = {
    1: Quantity.FORCE,
    2: Quantity.FIELD,
    4: Quantity.RATE,
    6: Quantity.PRESSURE,
    9: Quantity.GRAVITY,
    10: Quantity.LINEAR,
    11: Quantity.ROTATION_VECTOR,
}
"""Numbers of Android's sensor types, which some recorders write instead of names."""
