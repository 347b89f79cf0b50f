"""Titles of many recorders, languages and ways of writing are understood, and what means something else is not."""

import pytest

from pdr_est.io.tables.header import understand_titles
from pdr_est.io.tables.quantities import Quantity, unit_factor
from pdr_est.io.tables.titles import sensor_by_name, understand_title

DEG = 0.017453292519943295
G = 9.80665
ROWS = """
time,ax,ay,az,gx,gy,gz
timestamp;AccX;AccY;AccZ;GyrX;GyrY;GyrZ
t,Acceleration x (m/s^2),Acceleration y (m/s^2),Acceleration z (m/s^2),Gyroscope x,Gyroscope y,Gyroscope z
time,ω_x,ω_y,ω_z,a_x,a_y,a_z
time,ωx,ωy,ωz,ax,ay,az
時間,X軸加速度,Y軸加速度,Z軸加速度,X軸角速度,Y軸角速度,Z軸角速度
時刻,加速度X(G),加速度Y(G),加速度Z(G),角速度X(dps),角速度Y(dps),角速度Z(dps)
時刻,加速度センサーX,加速度センサーY,加速度センサーZ,ジャイロセンサーX,ジャイロセンサーY,ジャイロセンサーZ
时间,加速度计X轴,加速度计Y轴,加速度计Z轴,陀螺仪X轴,陀螺仪Y轴,陀螺仪Z轴
时间戳,X轴加速度,Y轴加速度,Z轴加速度,X轴角速度,Y轴角速度,Z轴角速度
시간,X축 가속도,Y축 가속도,Z축 가속도,자이로 X,자이로 Y,자이로 Z
시간,가속도 X,가속도 Y,가속도 Z,각속도 X,각속도 Y,각속도 Z
Tiempo,Acelerómetro x,Acelerómetro y,Acelerómetro z,Giróscopo x,Giróscopo y,Giróscopo z
tempo,aceleração x,aceleração y,aceleração z,giroscópio x,giroscópio y,giroscópio z
temps,accélération x,accélération y,accélération z,vitesse angulaire x,vitesse angulaire y,vitesse angulaire z
Zeit,Beschleunigung x,Beschleunigung y,Beschleunigung z,Drehrate x,Drehrate y,Drehrate z
Zeit,Beschleunigung in x-Richtung,Beschleunigung in y-Richtung,Beschleunigung in z-Richtung,Gyroskop X,Gyroskop Y,\
Gyroskop Z
tempo,accelerazione asse x,accelerazione asse y,accelerazione asse z,velocità angolare x,velocità angolare y,\
velocità angolare z
время,ускорение x,ускорение y,ускорение z,угловая скорость x,угловая скорость y,угловая скорость z
Время,Акселерометр Х,Акселерометр У,Акселерометр Z,Гироскоп Х,Гироскоп У,Гироскоп Z
tijd,versnelling x,versnelling y,versnelling z,hoeksnelheid x,hoeksnelheid y,hoeksnelheid z
czas,przyspieszenie x,przyspieszenie y,przyspieszenie z,prędkość kątowa x,prędkość kątowa y,prędkość kątowa z
Czas,Akcelerometr X,Akcelerometr Y,Akcelerometr Z,Żyroskop X,Żyroskop Y,Żyroskop Z
tid,acceleration x,acceleration y,acceleration z,vinkelhastighet x,vinkelhastighet y,vinkelhastighet z
zaman,ivme x,ivme y,ivme z,jiroskop x,jiroskop y,jiroskop z
time,acc1_x,acc1_y,acc1_z,gyr1_x,gyr1_y,gyr1_z
time,ACCX1,ACCY1,ACCZ1,GYROX1,GYROY1,GYROZ1
time,acc1,acc2,acc3,gyro1,gyro2,gyro3
time,Beschl. x,Beschl. y,Beschl. z,Gyro x,Gyro y,Gyro z
time,vehicle_acceleration.xyz[0],vehicle_acceleration.xyz[1],vehicle_acceleration.xyz[2],gyro[0],gyro[1],gyro[2]
time,ACCX_1,ACCY_1,ACCZ_1,GYRX_1,GYRY_1,GYRZ_1
time,acc[0],acc[1],acc[2],gyro[0],gyro[1],gyro[2]
time,AccX(g),AccY(g),AccZ(g),AsX(°/s),AsY(°/s),AsZ(°/s),AngleX(°),AngleY(°),AngleZ(°)
Time,GYROSCOPE Yaw (rad/s),GYROSCOPE Pitch (rad/s),GYROSCOPE Roll (rad/s),ACCELEROMETER X,ACCELEROMETER Y,\
ACCELEROMETER Z
Time,Acc X,Acc Y,Acc Z,Roll rate,Pitch rate,Yaw rate
time,X-axis angular velocity,Y-axis angular velocity,Z-axis angular velocity,X-axis acceleration,\
Y-axis acceleration,Z-axis acceleration
#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],\
a_RS_S_z [m s^-2]
Packet number,Gyroscope X (deg/s),Gyroscope Y (deg/s),Gyroscope Z (deg/s),Accelerometer X (g),Accelerometer Y (g),\
Accelerometer Z (g),Time (s)
time,gyroXrate,gyroYrate,gyroZrate,accXvalue,accYvalue,accZvalue
time,LSM6DSO acc x,LSM6DSO acc y,LSM6DSO acc z,LSM6DSO gyro x,LSM6DSO gyro y,LSM6DSO gyro z
time,rotation x (rad/s),rotation y (rad/s),rotation z (rad/s),accel x,accel y,accel z
t_ms,acc_mg_x,acc_mg_y,acc_mg_z,gyro_dps_x,gyro_dps_y,gyro_dps_z
uptime,xAccel,yAccel,zAccel,xGyro,yGyro,zGyro
time,BodyGyroX,BodyGyroY,BodyGyroZ,TotalAccX,TotalAccY,TotalAccZ
time,Accel_LN_X_CAL,Accel_LN_Y_CAL,Accel_LN_Z_CAL,Gyro_X_CAL,Gyro_Y_CAL,Gyro_Z_CAL
time,AccX_m/s^2,AccY_m/s^2,AccZ_m/s^2,GyrX_rad/s,GyrY_rad/s,GyrZ_rad/s
"""
HEADERS = [line for line in ROWS.replace("\\\n", "").splitlines() if line]


@pytest.mark.parametrize("line", HEADERS)
def test_accelerometer_gyroscope_and_time_are_found(line: str) -> None:
    titles = line.replace(";", ",").split(",")
    mapping = understand_titles(titles)
    assert Quantity.FORCE in mapping.columns
    assert Quantity.RATE in mapping.columns
    assert len(mapping.clocks) == 1
    assert not mapping.incomplete
    for quantity in (Quantity.FORCE, Quantity.RATE):
        chosen = mapping.columns[quantity].titles
        if not any(word in line.lower() for word in ("pitch", "acc[", "acc1,", "xyz[")):
            wanted = [{"x": "xх", "y": "yу", "z": "z"}[axis] for axis in "xyz"]
            for title, letters in zip(chosen, wanted, strict=True):
                assert set(letters) & set(title.lower())
        assert len(set(chosen)) == 3


@pytest.mark.parametrize(
    "title",
    [
        *("acc_mean_x", "gyro_std_y", "gyro_bias_x (rad/s)", "acc_x (std)", "velocity_x (m/s)", "speed_x", "pos_x"),
        *("x (m)", "roll (deg)", "AngleX(°)", "step count", "heading", "battery (%)", "Speed m/s", "wind km/h"),
    ],
)
def test_other_titles_mean_no_sensor(title: str) -> None:
    meaning = understand_title(title)
    named = meaning is not None and meaning.word is not None and meaning.word.quantity in (Quantity.TIME, "rate")
    assert not named
    mapping = understand_titles([title.replace("x", axis) for axis in "xyz"] if "x" in title else [title])
    assert not mapping.has_motion


@pytest.mark.parametrize(
    ("title", "factor"),
    [
        *(
            ("gyro x in degrees/s", DEG),
            ("gyro_x {°/s}", DEG),
            ("gyro_x (degrees/sec)", DEG),
            ("gyro_x (rad.s-1)", 1.0),
        ),
        *(("gyro x, deg/s", DEG), ("ω_x / (°/s)", DEG), ("wx/dps", DEG), ("gyro_x (rpm)", 0.10471975511965977)),
        *(("gyro_x_rad_s", 1.0), ("gyro x radians per second", 1.0), ("Gyroscope_X (Grad/s)", DEG)),
        *(
            ("gyroX|mdps", DEG / 1e3),
            ("角速度X [度/秒]", DEG),
            ("Угл. скорость X, °/с", DEG),
            ("gyro_x_deg_per_sec", DEG),
        ),
    ],
)
def test_units_of_a_rotation_rate(title: str, factor: float) -> None:
    meaning = understand_title(title)
    assert meaning is not None
    assert unit_factor(Quantity.RATE, meaning.unit) == pytest.approx(factor, rel=1e-12)


@pytest.mark.parametrize(
    ("unit", "factor"),
    [
        *(("m/s²", 1.0), ("m s^-2", 1.0), ("m.s-2", 1.0), ("m·s⁻²", 1.0), ("meters per second squared", 1.0)),
        *(("Meter pro Sekunde Quadrat", 1.0), ("米/秒²", 1.0), ("м/с²", 1.0), ("m/(s^2)", 1.0), ("m/s**2", 1.0)),
        *(("g's", G), ("G", G), ("mG", G / 1e3), ("milli-g", G / 1e3), ("g-force", G), ("cm/s²", 0.01)),
    ],
)
def test_units_of_an_acceleration(unit: str, factor: float) -> None:
    assert unit_factor(Quantity.FORCE, unit) == pytest.approx(factor, rel=1e-12)
    for style in ("acc_x ({})", "acc_x [{}]", "acc_x {{{}}}", "acc x in {}", "acc_x, {}", "acc_x / {}"):
        meaning = understand_title(style.format(unit))
        assert meaning is not None, style
        assert unit_factor(Quantity.FORCE, meaning.unit) == pytest.approx(factor, rel=1e-12), style


@pytest.mark.parametrize(
    ("name", "quantity"),
    [
        ("Акселерометр", Quantity.FORCE),
        ("Żyroskop", Quantity.RATE),
        ("Giróscopo", Quantity.RATE),
        ("陀螺仪传感器", Quantity.RATE),
        ("자이로스코프", Quantity.RATE),
        ("2031-02-03_Beschleunigungssensor", Quantity.FORCE),
    ],
)
def test_names_of_files_and_sensors(name: str, quantity: Quantity) -> None:
    assert sensor_by_name(name) is quantity


def test_a_text_that_is_no_known_unit_is_kept_and_divides_no_sensor() -> None:
    mapping = understand_titles(["t", "acc_x (m/s^2)", "acc_y (zorgs/s)", "acc_z (m/s^2)"])
    columns = mapping.columns[Quantity.FORCE]
    assert columns.factors == (1.0, None, 1.0)
    assert columns.unknown_units == ("", "zorgs/s", "")
    remarked = understand_title("acc_x (m/s^2, with gravity)")
    assert remarked is not None
    assert remarked.unit == "m/s^2"
    assert not mapping.incomplete
