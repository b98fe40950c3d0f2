"""Pins the metrics of `reflet compare` to scikit-image, flip-evaluator and NumPy.

Run with pytest (it needs NumPy and Pillow, and scikit-image or flip-evaluator as references;
what is missing is skipped and said). `python tests/tools/test_metric_reference.py` prints the
expected numbers that `tests/metric.rs` stores, so that Rust alone pins them too.
"""

import json
import subprocess

import pytest
from program import BINARY

np = pytest.importorskip("numpy", reason="the references are computed with NumPy")
Image = pytest.importorskip("PIL.Image", reason="test pictures are written with Pillow")

LUMA = np.array([0.299, 0.587, 0.114])  # Rec. 601 luma weights, as in Wang's script
SSIM_TOLERANCE = 1e-6
# Two releases of the same code, both in single precision: a pixel differs by more than the mean.
FLIP_MEAN_TOLERANCE = 1e-4
FLIP_PERCENTILE_TOLERANCE = 1e-3


def generated(width, height, seed):
    """Smooth color waves, a checker and deterministic noise, the same as in `tests/metric.rs`."""
    y, x = np.mgrid[0:height, 0:width].astype(np.uint64)
    planes = []
    for c in range(3):
        h = x * 73856093 + y * 19349663 + c * 83492791 + seed * 2654435761
        h = (h ^ (h >> np.uint64(13))) * np.uint64(1274126177) & np.uint64(0xFFFFFFFF)
        noise = (h ^ (h >> np.uint64(16))) & np.uint64(31)
        wave = (x * (3 + c) + y * 2) & np.uint64(127)
        checker = (((x >> np.uint64(3)) + (y >> np.uint64(3))) & np.uint64(1)) * np.uint64(64)
        planes.append(noise + wave + checker)
    return np.stack(planes, -1).astype(np.uint8)


def cases():
    """8-bit test and reference picture by case name."""
    a = generated(64, 48, 1)
    dark = generated(40, 33, 5) // np.uint8(16)
    specked = a.copy()
    specked[3::11, 2::13] = (0, 255, 128)
    specked[0, 0] = 255
    return {
        "other_noise": (generated(64, 48, 2), a),
        "shifted_1_px": (np.roll(a, 1, axis=1), a),
        "inverted": (255 - a, a),
        "specked": (specked, a),
        "brighter": (a + np.uint8(20), a),
        "dark": (generated(40, 33, 6) // np.uint8(16), dark),
        "one_window": (generated(11, 11, 3), generated(11, 11, 4)),
        "gray_levels": (np.full((20, 30, 3), 100, np.uint8), np.full((20, 30, 3), 130, np.uint8)),
    }


def mask_weights(shape):
    """Weight 200 inside an ellipse, and weight 1 (not over 1/255) around it."""
    height, width = shape[:2]
    y, x = np.mgrid[0:height, 0:width]
    inside = ((x - width / 2) / (0.45 * width)) ** 2 + ((y - height / 2) / (0.45 * height)) ** 2 < 1
    return np.where(inside, 200, 1).astype(np.uint8)


def eroded(inside, radius=5):
    """Mask eroded by brute force: every pixel of the square neighborhood must be inside."""
    padded = np.pad(inside, radius, constant_values=False)
    windows = np.lib.stride_tricks.sliding_window_view(padded, (2 * radius + 1, 2 * radius + 1))
    return windows.all(axis=(2, 3))


def ssim_map(test, reference):
    skimage = pytest.importorskip("skimage.metrics", reason="scikit-image is the SSIM reference")
    _, full = skimage.structural_similarity(
        test.astype(np.float64) @ LUMA,
        reference.astype(np.float64) @ LUMA,
        gaussian_weights=True,
        sigma=1.5,
        use_sample_covariance=False,
        data_range=255,
        full=True,
    )
    return full


def flip_map(test, reference):
    flip = pytest.importorskip("flip_evaluator", reason="flip-evaluator is the FLIP reference")
    as_unit = [(p / np.float32(255)).astype(np.float32) for p in (reference, test)]
    return flip.evaluate(*as_unit, "LDR", applyMagma=False)[0][..., 0]


def linear(picture):
    v = picture / 255.0
    return np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)


def specks(picture):
    """Whether each pixel differs by more than 0.3 from the median of the 5 × 5 around it."""
    found = np.zeros(picture.shape[:2], bool)
    for y, x in np.ndindex(found.shape):
        window = picture[max(y - 2, 0) : y + 3, max(x - 2, 0) : x + 3].reshape(-1, 3)
        median = np.sort(window, axis=0)[len(window) // 2]
        found[y, x] = (np.abs(picture[y, x].astype(float) - median) > 0.3 * 255).any()
    return found


def simple_errors(test, reference, where):
    squared = ((test.astype(float) - reference) ** 2).mean(-1)[where]
    r = linear(reference)
    relative = np.sort((((linear(test) - r) / (r + 0.01)) ** 2).mean(-1)[where])
    return {
        "psnr_db": 10 * np.log10(255**2 / squared.mean()),
        "rel_mse": relative.mean(),
        "rel_mse_trimmed": relative[: len(relative) - len(relative) // 1000].mean(),
        "max_difference": np.abs(test.astype(float) - reference).max(-1)[where].max(),
        "specks": (specks(test) & ~specks(reference))[where].mean(),
    }


@pytest.fixture(scope="session")
def binary():
    if not BINARY.is_file():
        pytest.skip(f"{BINARY} is missing: cargo build, or set REFLET")
    known = subprocess.run([BINARY, "compare", "--help"], capture_output=True)
    if known.returncode != 0:
        pytest.skip(f"{BINARY} has no command `compare`: build it again")
    return BINARY


def compare(binary, *arguments, code=0):
    done = subprocess.run([binary, "compare", *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == code, done.stderr
    return done


@pytest.fixture(params=list(cases()))
def scored(request, binary, tmp_path):
    """(test, reference, eroded mask, JSON of the binary) for one case."""
    test, reference = cases()[request.param]
    weights = mask_weights(test.shape)
    paths = [tmp_path / name for name in ("test.png", "reference.png", "mask.png")]
    for path, picture in zip(paths, (test, reference, weights), strict=True):
        Image.fromarray(picture).save(path)
    done = compare(binary, paths[0], paths[1], "--mask", paths[2], "--json")
    return test, reference, eroded(weights > 1), json.loads(done.stdout)


def test_ssim_is_that_of_scikit_image(scored):
    test, reference, mask, result = scored
    full = ssim_map(test, reference)
    assert abs(result["frame"]["ssim"] - full[5:-5, 5:-5].mean()) < SSIM_TOLERANCE
    if mask.sum() >= 100:
        assert abs(result["mask"]["scored"]["ssim"] - full[mask].mean()) < SSIM_TOLERANCE


def test_flip_is_that_of_flip_evaluator(scored):
    test, reference, mask, result = scored
    full = flip_map(test, reference)
    regions = [(result["frame"], full.ravel())]
    if mask.sum() >= 100:
        regions.append((result["mask"]["scored"], full[mask]))
    for scores, values in regions:
        assert abs(scores["flip_mean"] - values.mean()) < FLIP_MEAN_TOLERANCE
        assert abs(scores["flip_p95"] - np.percentile(values, 95)) < FLIP_PERCENTILE_TOLERANCE
        assert abs(scores["flip_p99"] - np.percentile(values, 99)) < FLIP_PERCENTILE_TOLERANCE


def test_errors_are_those_of_numpy(scored):
    test, reference, mask, result = scored
    assert result["mask"]["area_px"] == mask.sum()
    regions = [(result["frame"], np.ones(mask.shape, bool))]
    if mask.sum() >= 100:
        regions.append((result["mask"]["scored"], mask))
    else:
        assert "scored" not in result["mask"] and "too small" in result["mask"]["too_small"]
    for scores, where in regions:
        for name, value in simple_errors(test, reference, where).items():
            assert scores[name] == pytest.approx(value, rel=1e-5), name


def test_mask_of_ones_matches_nothing(binary, tmp_path):
    """A mask weight of exactly 1/255 is not over 1/255, so such a mask holds no pixel."""
    picture, mask = generated(32, 32, 1), np.full((32, 32), 1, np.uint8)
    Image.fromarray(picture).save(tmp_path / "a.png")
    Image.fromarray(mask).save(tmp_path / "m.png")
    done = compare(binary, *[tmp_path / "a.png"] * 2, "--mask", tmp_path / "m.png", "--json")
    assert json.loads(done.stdout)["mask"]["area_px"] == 0


def test_thresholds_exit_with_6(binary, tmp_path):
    test, reference = cases()["other_noise"]
    a, b = tmp_path / "a.png", tmp_path / "b.png"
    Image.fromarray(test).save(a)
    Image.fromarray(reference).save(b)
    compare(binary, a, b, "--max-flip", 1, "--min-ssim", 0)
    done = compare(binary, a, b, "--max-flip", 0.001, "--min-ssim", 0.999, code=6)
    assert done.stdout.count("FAILED") == 2
    compare(binary, a, a, "--max-flip", 0, "--min-ssim", 1)


def print_expected():
    for name, (test, reference) in cases().items():
        flip, ssim = flip_map(test, reference).astype(float), ssim_map(test, reference)
        mask = eroded(mask_weights(test.shape) > 1)
        masked = ssim[mask].mean() if mask.sum() >= 100 else None
        values = [np.percentile(flip, p) for p in (95, 99)]
        masked = "None" if masked is None else f"Some({masked:.9f})"
        print(
            f'        ("{name}", {ssim[5:-5, 5:-5].mean():.9f}, {masked}, '
            f"[{flip.mean():.6f}, {values[0]:.6f}, {values[1]:.6f}]),"
        )


if __name__ == "__main__":
    print_expected()
