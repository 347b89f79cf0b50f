"""Plans made of pictures: walls by their darkness, and the map by two known points."""

from pathlib import Path

import numpy as np
import pytest

from pdr_est.errors import FloorPlanError
from pdr_est.io.floor_plans.picture import KnownPoint, read_plan_picture
from pdr_est.io.floor_plans.reading import read_floor_plan
from pdr_est.io.floor_plans.writing import write_floor_plan

pytest.importorskip("shapely")
image_library = pytest.importorskip("PIL.Image")
skimage_io = pytest.importorskip("skimage.io")

SCALE = 0.05  # m a pixel


def picture(path: Path, colour: bool = False) -> Path:
    """Draw a hall of 30 m x 20 m with a closed block of 10 m x 6 m in it, a letter, and a label outside."""
    image = np.full((500, 700), 250, dtype=np.uint8)
    image[46:54, 46:654] = image[446:454, 46:654] = 20
    image[46:454, 46:54] = image[46:454, 646:654] = 20
    image[200:320, 200:400] = 20
    image[100:112, 500:508] = 20  # 0.6 m x 0.4 m
    image[470:480, 300:310] = 20
    if colour:
        image = np.dstack([image, image, image, np.where(image > 200, 0, 255).astype(np.uint8)])
    skimage_io.imsave(path, image, check_contrast=False)
    return path


def point(column: float, row: float, turn: complex = 1.0) -> KnownPoint:
    """Return a pixel with its position, with the lower left corner of the hall at (100, 200) in a turned map."""
    at = turn * SCALE * complex(column - 50, 450 - row) + complex(100.0, 200.0)
    return KnownPoint(column, row, at.real, at.imag)


@pytest.mark.parametrize("colour", [False, True])
@pytest.mark.parametrize("angle_deg", [0.0, 30.0])
def test_the_hall_is_walkable_at_its_place(tmp_path: Path, colour: bool, angle_deg: float) -> None:
    turn = complex(np.exp(1j * np.deg2rad(angle_deg)))
    path = picture(tmp_path / "hall.png", colour)
    plan = read_plan_picture(path, [point(50, 450, turn), point(650, 50, turn)], floor="F1")
    assert (plan.name, plan.floor, plan.sigma_m) == ("hall", "F1", pytest.approx(0.1))
    inner_m2 = (592 * 392 - 120 * 200) * SCALE**2
    assert plan.area_m2 == pytest.approx(inner_m2, rel=5e-3)
    assert [len(area.holes_m) for area in plan.areas] == [1]  # the block; the letter is none

    def position(column: float, row: float) -> tuple[float, float]:
        one = point(column, row, turn)
        return one.x_m, one.y_m

    inside = plan.contains(np.array([position(100, 100), position(504, 106), position(300, 260), position(20, 20)]))
    assert inside.tolist() == [True, True, False, False]
    corner = np.array(position(54, 446))
    assert np.linalg.norm(plan.borders_m[:, 0] - corner, axis=1).min() < 2.0 * SCALE


def test_rooms_are_chosen_by_positions_inside(tmp_path: Path) -> None:
    path = picture(tmp_path / "hall.png")
    known = [point(50, 450), point(650, 50)]
    outdoors = read_plan_picture(path, known, inside_m=[(99.0, 199.0)])
    assert outdoors.contains(np.array([[99.0, 199.0], [101.0, 201.0]])).tolist() == [True, False]
    with pytest.raises(FloorPlanError, match="lies on a wall"):
        read_plan_picture(path, known, inside_m=[(112.0, 209.0)])
    with pytest.raises(FloorPlanError, match="lies outside of the picture"):
        read_plan_picture(path, known, inside_m=[(0.0, 0.0)])


def test_what_cannot_be_a_plan_is_refused_in_words(tmp_path: Path) -> None:
    path = picture(tmp_path / "hall.png")
    known = [point(50, 450), point(650, 50)]
    with pytest.raises(FloorPlanError, match="1 known points: give two"):
        read_plan_picture(path, known[:1])
    with pytest.raises(FloorPlanError, match="a pixel is 0 m wide"):
        read_plan_picture(path, [known[0], known[0]])
    with pytest.raises(FloorPlanError, match="column 900, row 10 lies outside of the picture of 700 x 500 pixels"):
        read_plan_picture(path, [known[0], KnownPoint(900, 10, 0, 0)])
    with pytest.raises(FloorPlanError, match=r"the known point \(nan, 0"):
        read_plan_picture(path, [known[0], KnownPoint(650, 50, float("nan"), 0.0)])
    with pytest.raises(FloorPlanError, match="km from the origin of the map frame"):
        read_plan_picture(path, [KnownPoint(one.column, one.row, one.x_m + 1e9, one.y_m) for one in known])
    with pytest.raises(FloorPlanError, match=r"the position \(nan, 0\) m lies outside"):
        read_plan_picture(path, known, inside_m=[(float("nan"), 0.0)])
    with pytest.raises(FloorPlanError, match="sigma_m = nan"):
        read_plan_picture(path, known, sigma_m=float("nan"))
    with pytest.raises(FloorPlanError, match="no room is closed by walls"):
        read_plan_picture(path, known, darkness=0.99)
    with pytest.raises(FloorPlanError, match="no such file"):
        read_plan_picture(tmp_path / "other.png", known)
    (tmp_path / "text.png").write_text("hello")
    with pytest.raises(FloorPlanError, match="is no picture"):
        read_plan_picture(tmp_path / "text.png", known)
    (tmp_path / "half.png").write_bytes(path.read_bytes()[:300])
    with pytest.raises(FloorPlanError, match="is no picture that can be read"):
        read_plan_picture(tmp_path / "half.png", known)
    skimage_io.imsave(tmp_path / "white.png", np.full((500, 700), 255, dtype=np.uint8), check_contrast=False)
    with pytest.raises(FloorPlanError, match="a single colour"):
        read_plan_picture(tmp_path / "white.png", known)


def test_the_written_plan_is_read_again(tmp_path: Path) -> None:
    made = read_plan_picture(picture(tmp_path / "hall.png"), [point(50, 450), point(650, 50)], floor="F1")
    write_floor_plan(made, tmp_path / "plan.geojson")
    again = read_floor_plan(tmp_path / "plan.geojson", "F1")
    assert again.area_m2 == pytest.approx(made.area_m2, rel=1e-4)
    assert again.bounds_m == pytest.approx(made.bounds_m, abs=1e-3)
    assert (again.sigma_m, again.origin) == (made.sigma_m, None)


def test_pictures_that_fill_the_memory_or_hold_no_numbers_are_refused(tmp_path: Path) -> None:
    known = [point(50, 450), point(650, 50)]
    image_library.new("1", (9500, 9500), 1).save(tmp_path / "large.png")
    with pytest.raises(FloorPlanError, match="90250000 pixels"):
        read_plan_picture(tmp_path / "large.png", known)
    image_library.fromarray(np.full((500, 700), np.nan, dtype=np.float32)).save(tmp_path / "hall.tif")
    with pytest.raises(FloorPlanError, match="no finite numbers"):
        read_plan_picture(tmp_path / "hall.tif", known)


def test_a_photo_is_read_as_programs_show_it(tmp_path: Path) -> None:
    shown = image_library.open(picture(tmp_path / "hall.png")).convert("L")
    turned_right = 6
    stored = shown.rotate(90, expand=True)
    exif = stored.getexif()
    exif[0x0112] = turned_right
    stored.save(tmp_path / "hall.jpg", exif=exif, quality=95)
    known = [point(50, 450), point(650, 50)]
    photo = read_plan_picture(tmp_path / "hall.jpg", known)
    assert photo.bounds_m == pytest.approx(read_plan_picture(tmp_path / "hall.png", known).bounds_m, abs=0.3)
