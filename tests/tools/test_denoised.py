"""The flicker of denoised films: it counts grain that stays behind surfaces."""

import numpy as np
import pytest
from documents.denoised import Frame, View, at_rest, error_change, moved

SIZE = (36, 64)
DEPTH = 4.0
FOV_DEG = 40.0
# Width of a pixel on the wall that the camera faces, meters.
PIXEL = 2 * np.tan(np.radians(FOV_DEG) / 2) * DEPTH / SIZE[0]


def wall(eye_x: float) -> Frame:
    """A wall before a camera that looks along -Z from this place."""
    eye = np.array([eye_x, 0.0, 0.0])
    view = View(eye, np.array([eye_x, 0.0, -1.0]), FOV_DEG)
    return Frame(np.full(SIZE, DEPTH), np.zeros(SIZE, dtype=int), view)


def film(pixels_per_frame: float) -> list[Frame]:
    return [wall(PIXEL * pixels_per_frame * i) for i in range(4)]


def on_the_wall(frame: Frame) -> np.ndarray:
    """A smooth texture of the wall, three channels."""
    return np.sin(3 * frame.positions()) * 20


def on_the_screen(frame: Frame) -> np.ndarray:
    """Patches that stay where they are in the picture."""
    x = np.arange(SIZE[1]) * 0.7
    return np.broadcast_to(np.sin(x)[None, :, None] * 20, (*SIZE, 3))


def no_light(frames: list[Frame]) -> list[np.ndarray]:
    return [np.zeros((*SIZE, 3)) for _ in frames]


def test_surfaces_are_found_where_the_camera_has_moved():
    frames = film(3)
    values = np.arange(SIZE[0] * SIZE[1], dtype=float).reshape(*SIZE, 1) + np.zeros(3)
    found, known = moved(values, frames[0], frames[1])
    assert known[:, : SIZE[1] - 3].all()
    assert not known[:, SIZE[1] - 3 :].any()
    assert np.allclose(found[:, : SIZE[1] - 3], values[:, 3:])
    other = Frame(frames[1].depth, frames[1].instance + 1, frames[1].view)
    assert not moved(values, frames[0], other)[1].any()
    nearer = Frame(frames[0].depth * 0.9, frames[0].instance, frames[0].view)
    assert not moved(values, nearer, frames[1])[1].any()


@pytest.mark.parametrize("speed", [0.0, 1.0, 2.4])
def test_errors_that_go_with_their_surface_do_not_flicker(speed):
    frames = film(speed)
    references = [no_light(frames)] * 2
    own = error_change([on_the_wall(frame) for frame in frames], references, frames)
    swimming = error_change([on_the_screen(frame) for frame in frames], references, frames)
    assert own < 0.1
    assert (swimming > 5) == (speed > 0)


def test_grain_of_two_references_does_not_count():
    frames = film(1)
    random = np.random.default_rng(1)
    grainy = [[random.normal(0, 8, (*SIZE, 3)) for _ in frames] for _ in range(2)]
    pictures = [on_the_screen(frame) for frame in frames]
    clean = error_change(pictures, [no_light(frames)] * 2, frames)
    assert abs(error_change(pictures, grainy, frames) / clean - 1) < 0.08
    assert error_change(pictures, [grainy[0]] * 2, frames) > 1.2 * clean


def test_a_camera_at_rest_counts_what_rests_in_the_reference():
    before = np.zeros((2, 2, 3))
    truth, picture = before.copy(), before.copy()
    truth[0, 0] = 9
    picture[0, 0], picture[1, 1] = 50, 6
    mean, square = at_rest([before, picture], [before, truth])
    assert mean == pytest.approx(2)
    assert square == pytest.approx(np.sqrt(12))
