"""The module of Python: its files equal the program's, its arrays are right, its errors clear."""

import io
import json
import os
import signal
import subprocess
import sys
import threading
import warnings
from pathlib import Path
from types import ModuleType

import pytest
import tomllib
from program import BINARY, ROOT
from texts import text_of

np = pytest.importorskip("numpy", reason="pictures are arrays of NumPy")
Image = pytest.importorskip("PIL.Image", reason="pictures are opened with Pillow")


#: A moving chrome ball over a floor, with a parameter, a variant and two cameras.
SCENE = text_of("python/scene.toml")
SCRIPT = text_of("python/frame.rhai")

#: A square of two triangles, seen from 5 m.
SQUARE = tomllib.loads(text_of("python/square.toml"))


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """A folder with the scene."""
    (tmp_path / "scene.toml").write_text(SCENE)
    (tmp_path / "ball.rhai").write_text(SCRIPT)
    return tmp_path / "scene.toml"


def run(*arguments: object) -> subprocess.CompletedProcess[str]:
    """Run the program."""
    words = [str(word) for word in arguments]
    done = subprocess.run([BINARY, *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done


def render(scene: Path, out: Path, *more: object) -> Path:
    """Render with the program."""
    run("render", scene, "-o", out, *more)
    return out


def test_files_equal_those_of_the_program(reflet: ModuleType, scene: Path) -> None:
    folder = scene.parent
    (folder / "own").mkdir()
    options = {"set": {"image.samples": 3, "params.height": 0.75}, "variant": "night"}
    told: list[tuple[int, int | None]] = []
    with reflet.open(scene, **options) as session:
        assert session.timeline == (0, 3, 24.0)
        assert session.cameras == ["main", "side"]
        assert session.parameters == {"height": 0.75}
        picture = session.render(aovs=["depth", "cause"], progress=lambda *n: told.append(n))
        assert [line.split(": ")[-1] for line in picture.log] == ["frame 0"]
        assert told[-1] == (3, 3)
        names = ["own.png", "own.depth.png", "own.cause.png"]
        assert picture.save(folder / "own.png") == [folder / name for name in names]
        picture.save(folder / "own.exr")
        crop = np.array([4, 2, 20, 10])
        side = session.render(camera="side", size=[32, 18], method="rt", crop=crop)
        side.save(folder / "side.png")
        for frame in session.frames("1-2", aovs=["ids"]):
            assert frame.log[0].endswith(f": frame {frame.frame}")
            frame.save(folder / "own" / "film.####.exr")
    assert session.closed
    settings = ["--set", "image.samples=3", "--set", "params.height=0.75", "--variant", "night"]
    for name in ("png", "exr"):
        own, other = folder / f"own.{name}", folder / f"program.{name}"
        render(scene, other, *settings, "--aov", "depth,cause")
        assert own.read_bytes() == other.read_bytes(), name
    for aov in ("depth", "cause"):
        own, other = folder / f"own.{aov}.png", folder / f"program.{aov}.png"
        assert own.read_bytes() == other.read_bytes(), aov
    view = ["--camera", "side", "--size", "32x18", "--method", "rt", "--crop", "4,2,20,10"]
    other = render(scene, folder / "other.png", *settings, *view)
    assert (folder / "side.png").read_bytes() == other.read_bytes()
    film = folder / "own" / "film.####.exr"
    frames = ["--aov", "ids", "--frames", "0-2"]
    done = run("render", scene, "-o", film, *settings, *frames, "--resume")
    assert done.stderr.count("kept") == 2, done.stderr
    before = [(folder / "own" / f"film.{n:04}.exr").read_bytes() for n in (1, 2)]
    render(scene, folder / "new.####.exr", *settings, "--aov", "ids", "--frames", "1-2")
    assert before == [(folder / f"new.{n:04}.exr").read_bytes() for n in (1, 2)]


def test_pictures_are_arrays(reflet: ModuleType, scene: Path) -> None:
    with reflet.open(scene) as session:
        picture = session.render(aovs=reflet.AOVS)
    # Pictures outlive their session.
    assert picture.size == (48, 27)
    shapes = {"depth": (), "reflectance": (), "hit_distance": (), "source": (), "cause": ()}
    shapes |= {"ids": (2,), "hit_ids": (2,)}
    for name in picture:
        assert picture[name].shape == (27, 48, *shapes.get(name, (3,))), name
        kind = np.uint32 if name in ("source", "cause", "ids", "hit_ids") else np.float32
        assert picture[name].dtype == kind, name
    assert len(picture) == len(reflet.AOVS) == 14
    assert (picture.radiance.shape, picture.radiance.dtype) == ((27, 48, 4), np.float32)
    assert (picture.display.shape, picture.display.dtype) == ((27, 48, 4), np.uint8)
    seen = np.isfinite(picture["depth"])
    assert np.allclose(np.linalg.norm(picture["normal"][seen], axis=-1), 1, atol=1e-3)
    counts = {share["name"]: share["pixels"] for share in picture.stats["shares"]["causes"]}
    hidden = picture["cause"] == reflet.CAUSES.index("hidden")
    assert picture.stats["samples"] > 1 or counts["hidden"] == hidden.sum()

    with_pillow = Image.fromarray(picture.display)
    assert np.array_equal(with_pillow, picture.display)
    assert np.array_equal(Image.fromarray(picture), picture.display)
    shown = Image.open(io.BytesIO(picture._repr_png_()))
    assert np.array_equal(shown, picture.display[..., :3])
    for array in (np.from_dlpack(picture), np.asarray(picture)):
        assert np.shares_memory(array, picture.display)
    assert np.shares_memory(np.from_dlpack(picture.radiance), picture.radiance)
    assert np.asarray(picture, dtype=np.float64).dtype == np.float64


def test_written_pixels_are_saved(reflet: ModuleType, scene: Path, tmp_path: Path) -> None:
    with reflet.open(scene) as session:
        picture = session.render()
    picture.display[2, 3] = (1, 2, 3, 255)
    [path] = picture.save(tmp_path / "out.png")
    assert tuple(np.asarray(Image.open(path))[2, 3]) == (1, 2, 3)
    picture.display.shape = (27 * 48, 4)
    [path] = picture.save(tmp_path / "out.png")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        picture.display.dtype = np.int8
    with pytest.raises(reflet.ArgumentError, match="another shape"):
        picture.save(tmp_path / "out.png")


def test_the_sample_of_the_manual_runs_as_it_stands(
    reflet: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The scene beside it has the names that the sample mentions."""
    (tmp_path / "lib").mkdir()
    (tmp_path / "height.rhai").write_text("fn frame(ctx) {}")
    (tmp_path / "scene.toml").write_text(text_of("python/sample.toml"))
    manual = (ROOT / "docs/python.md").read_text(encoding="utf-8")
    (sample,) = manual.split("```python\n")[1:]
    monkeypatch.chdir(tmp_path)
    exec(sample.split("```")[0], {"__name__": "sample"})
    assert len(list(Path("out").iterdir())) == 48


def test_a_query_agrees_with_the_picture(reflet: ModuleType, scene: Path) -> None:
    with reflet.open(scene) as session:
        answer = session.query(2, at=[(24, 13)], of=["ball"])
        picture = session.render(2, aovs=["ids"])
        names = session.instances
        with pytest.raises(reflet.ArgumentError):
            session.query(at=[(48, 0)])
    [surface] = answer["pixels"][0]["surfaces"]
    assert names[picture["ids"][13, 24, 0]] == surface["thing"]
    share = np.mean(picture["ids"][..., 0] == names.index("ball"))
    assert share == pytest.approx(answer["things"][0]["share"], abs=0.01)
    clip = np.array(answer["clip_from_view"]) @ answer["view_from_world"] @ [*surface["at_m"], 1]
    place = (clip[:2] / clip[3] * [1, -1] + 1) / 2 * picture.size
    assert place == pytest.approx([24.5, 13.5], abs=0.01)


def test_a_scene_is_a_file_a_text_or_a_dict(reflet: ModuleType, scene: Path) -> None:
    ways = [
        {"scene": scene},
        {"text": SCENE, "folder": scene.parent},
        {"scene": tomllib.loads(SCENE), "folder": scene.parent},
        {"scene": scene, "text": SCENE},
    ]
    pictures = []
    for way in ways:
        with reflet.open(**way) as session:
            pictures.append(session.render(2).display)
    assert all(np.array_equal(pictures[0], other) for other in pictures[1:])
    with reflet.open(scene, text=SCENE.replace("0.5\nimage", "1.5\nimage")) as session:
        assert session.parameters == {"height": 1.5}
    numpy_scene = SQUARE | {"image": {"size": np.array([16, 16]), "samples": np.int64(1)}}
    with reflet.open(numpy_scene) as session:
        assert session.size == (16, 16)
    with reflet.open(SQUARE, size=np.array([12, 8], dtype=np.int16)) as session:
        assert session.size == (12, 8)
    for wrong, says in [
        ({"version": None}, "version: None is no value"),
        ({"a": {"b": [1, {2: 3}]}}, r"a.b\[1\]: keys must be text, not int"),
        ({"a": object()}, "a: object is no value of scene text"),
    ]:
        with pytest.raises(TypeError, match=says):
            reflet.open(wrong)
    endless: dict[str, object] = {}
    endless["a"] = endless
    with pytest.raises(ValueError, match="lists and tables"):
        reflet.open(endless)


def test_meshes_are_moved(reflet: ModuleType) -> None:
    rest = np.array(SQUARE["model"]["cloth"]["shape"]["positions"], float)
    with reflet.open(SQUARE) as session:
        assert np.allclose(session.render(aovs="depth")["depth"], 5)
        near = rest + np.array([0, 0, 2])
        for positions in (near, near.astype(np.float32), np.asfortranarray(near), near.tolist()):
            session.mesh("cloth", positions=positions)
            assert np.allclose(session.render(aovs="depth")["depth"], 3)
        normals = np.tile([1.0, 0, 1], (4, 1))
        session.mesh("cloth", positions=rest, normals=normals)
        picture = session.render(aovs=["depth", "normal"])
        assert np.allclose(picture["depth"], 5)
        assert np.allclose(picture["normal"], normals[0] / 2**0.5, atol=1e-3)
        session.mesh("cloth", positions=near)
        session.set("image.size", [8, 8])
        assert np.allclose(session.render(aovs="depth")["depth"], np.full((8, 8), 3.0))
        bad = near.copy()
        bad[1, 2] = np.nan
        for wrong, error, says in [
            ({"positions": near[:3]}, reflet.ArgumentError, "must be 12 numbers"),
            ({"positions": near.ravel()}, reflet.ArgumentError, r"shape \(N, 3\).*\(12,\)"),
            ({"positions": near.astype(complex)}, reflet.ArgumentError, "real numbers"),
            ({"positions": [["a", "b", "c"]]}, reflet.ArgumentError, "real numbers"),
            ({"positions": bad}, reflet.ArgumentError, "number 5 is NaN"),
            ({"positions": [[1, 2, 3], [1, 2]]}, reflet.ArgumentError, "positions are no array"),
            ({"positions": near * 1e300}, reflet.ArgumentError, "number 0 is -inf"),
            ({"positions": near, "normals": bad}, reflet.ArgumentError, "normals.*number 5 is NaN"),
        ]:
            with np.errstate(all="ignore"), pytest.raises(error, match=says):
                session.mesh("cloth", **wrong)
        with pytest.raises(reflet.UnknownNameError, match="no model `cloths`; did you mean"):
            session.mesh("cloths", positions=near)
        with pytest.raises(reflet.ArgumentError, match="cannot be deformed"):
            session.mesh("ball", positions=near)
        with pytest.raises(reflet.SceneError):
            session.set("model.cloth.shape.dynamic", "yes")
        with pytest.raises(reflet.ArgumentError, match="cannot be deformed"):
            session.set("model.cloth.shape.dynamic", False)
        assert np.allclose(session.render(aovs="depth")["depth"], 3)


def test_moved_meshes_equal_written_ones(reflet: ModuleType, scene: Path) -> None:
    """Also while the shutter is open, which poses the scene at several moments of the frame."""

    def with_cloth(positions: object) -> dict[str, object]:
        described = tomllib.loads(SCENE)
        described["image"]["shutter"] = 0.5
        shape = SQUARE["model"]["cloth"]["shape"] | {"positions": positions}
        described["model"]["floor"] = {"shape": shape, "material": "tiles"}
        return described

    rest = np.array(SQUARE["model"]["cloth"]["shape"]["positions"], np.float32)
    near = rest + np.array([0, 0.25, -1], np.float32)
    folder = scene.parent
    with reflet.open(with_cloth(near), folder=folder) as session:
        written = session.render(2, aovs="depth")
    with reflet.open(with_cloth(rest), folder=folder) as session:
        before = session.render(2)
        session.mesh("floor", positions=near)
        moved = session.render(2, aovs="depth")
    assert np.array_equal(moved["depth"], written["depth"])
    assert np.abs(moved.display.astype(int) - written.display).max() <= 1
    assert not np.array_equal(before.display, moved.display)


def test_errors_have_places(reflet: ModuleType, scene: Path, tmp_path: Path) -> None:
    scene.write_text(SCENE.replace("roughness", "roughnes"))
    with pytest.raises(reflet.SceneError) as caught:
        reflet.open(scene)
    error = caught.value
    assert (error.file, error.line, error.column) == (scene, 8, 35)
    assert "roughness" in error.help
    assert f"{scene}:8:35" in str(error)
    assert error.diagnostics[0].severity == "error"
    with pytest.raises(reflet.SceneError, match="<text>:1:"):
        reflet.open(text="version = 1\nx = 2\n".replace("version = 1\n", "versio = 1\n"))
    with pytest.raises(reflet.SceneError) as caught:
        reflet.open(tmp_path / "none.toml")
    assert caught.value.line is None
    scene.write_text(SCENE)
    for options, error, says in [
        ({"camera": "mian"}, reflet.UnknownNameError, "no camera `mian`; did you mean `main`"),
        ({"adapter": "no such adapter"}, reflet.NoAdapterError, "no such adapter"),
        ({"method": "rays"}, reflet.SceneError, "reflection.method"),
        ({"size": (0, 5)}, reflet.SceneError, "size"),
        ({"size": (-1, 5)}, reflet.SceneError, "size"),
        ({"size": [48]}, TypeError, r"^size: 2 whole numbers are wanted, not \[48\]$"),
        ({"size": [2**70, 3]}, reflet.ArgumentError, "size: a number is negative or too large"),
        ({"set": {"image.samples": 2**70}}, reflet.ArgumentError, "image.samples: .* 64 bits"),
        ({"folder": tmp_path}, reflet.ArgumentError, "folder="),
        ({"variant": 5}, reflet.ArgumentError, "variant is a text"),
        ({"sample": 5}, TypeError, "sample"),
        ({"lenient": True, "strict": True}, reflet.ArgumentError, "exclude each other"),
    ]:
        with pytest.raises(error, match=says):
            reflet.open(scene, **options)
    with pytest.raises(reflet.ArgumentError, match="a scene is a path"):
        reflet.open(5)
    model = tmp_path / "point.gltf"
    model.write_text("""{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": 3}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 0}]}],
        "accessors": [{"componentType": 5126, "type": "VEC3", "count": 1}]}""")
    with pytest.warns(reflet.SceneWarning, match="/nodes/0/name"):
        reflet.open(model).close()
    with pytest.raises(reflet.SceneError, match="not glTF JSON"):
        reflet.open(model, strict=True)
    with reflet.open(scene) as session:
        for options, error, says in [
            ({"frame": 4}, reflet.FrameError, "no frame 4; the timeline has 0 to 3"),
            ({"frame": -1}, reflet.FrameError, "no frame -1"),
            ({"samples": -1}, reflet.ArgumentError, "samples: a number is negative or too large"),
            ({"aovs": ["dpeth"]}, reflet.UnknownNameError, "no AOV `dpeth`"),
            ({"camera": "mian"}, reflet.UnknownNameError, "no camera `mian`"),
            ({"method": "rays"}, reflet.UnknownNameError, "no method `rays`; there are: ssr"),
            ({"size": (0, 5)}, reflet.ArgumentError, "each side must be 1 to 16384"),
            ({"samples": 0}, reflet.ArgumentError, "1 to 4096"),
            ({"crop": (40, 0, 20, 20)}, reflet.ArgumentError, "not inside of the picture"),
            ({"size": "large"}, TypeError, "^size: 2 whole numbers are wanted, not 'large'$"),
            ({"size": (48, 27, 1)}, TypeError, r"^size: 2 whole numbers are wanted, not \("),
            ({"size": [4.5, 3]}, TypeError, "^size: 2 whole numbers"),
            ({"size": {0: 4, 1: 3}}, TypeError, "^size: 2 whole numbers"),
            ({"size": np.array([-4, 3])}, reflet.ArgumentError, "size: a number is negative"),
            ({"size": [2**70, 3]}, reflet.ArgumentError, "size: a number is negative or too large"),
            ({"crop": [0, 0, 5]}, TypeError, "^crop: 4 whole numbers"),
            ({"dnoise": True}, TypeError, "dnoise: there is no such argument"),
        ]:
            with pytest.raises(error, match=says):
                session.render(**options)
        with pytest.raises(reflet.FrameError, match="frame 7 is not in the timeline"):
            session.frames("0-7")
        picture = session.render()
        with pytest.raises(KeyError, match="rendered without it"):
            picture["depth"]
        for path, says in [
            (tmp_path / "out.jpg", "the name of a picture must end in .png or .exr$"),
            (tmp_path / "out.apng", "must end in .png or .exr, not in .apng, which is a film"),
            (tmp_path / "none" / "out.png", "create it first"),
            (scene.with_suffix(".png"), None),
        ]:
            if says:
                with pytest.raises(reflet.ArgumentError, match=says):
                    picture.save(path)
        with pytest.raises(reflet.SceneError) as caught:
            session.set({"image.sampels": 3})
        assert "samples" in caught.value.help
        assert session.render(3).frame == 3
    calls = (session.render, session.__enter__, lambda: session.frame)
    for call in (*calls, lambda: session.set("image.samples", 1)):
        with pytest.raises(reflet.ClosedError, match="closed"):
            call()
    session.close()
    assert "closed" in repr(session)


def test_warnings_are_those_of_python(reflet: ModuleType, scene: Path, tmp_path: Path) -> None:
    with pytest.warns(reflet.SceneWarning, match="no such folder"):
        session = reflet.open(scene, assets=[tmp_path / "none"])
    assert session.warnings[0].severity == "warning"
    session.close()
    with warnings.catch_warnings(), pytest.raises(reflet.SceneWarning):
        warnings.simplefilter("error")
        reflet.open(scene, assets=[tmp_path / "none"])


def test_ctrl_c_and_errors_of_progress_end_a_picture(reflet: ModuleType, scene: Path) -> None:
    # Python leaves the signal ignored where the tests run in the background of a shell.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        check_endings(reflet, scene)
    finally:
        signal.signal(signal.SIGINT, before)


def check_endings(reflet: ModuleType, scene: Path) -> None:
    told: list[int] = []

    def press(done: int, _total: int | None) -> None:
        told.append(done)
        signal.raise_signal(signal.SIGINT)

    def fail(_done: int, _total: int | None) -> None:
        raise RuntimeError("enough")

    with reflet.open(scene, samples=4096) as session:
        with pytest.raises(KeyboardInterrupt):
            session.render(progress=press)
        assert told
        assert told[-1] < 4096
        with pytest.raises(RuntimeError, match="enough"):
            session.render(progress=fail)
        with pytest.raises(reflet.Error, match="its progress function cannot use it"):
            session.render(progress=lambda *_: session.frame)
        with pytest.raises(RuntimeError, match="enough"):
            next(session.frames(progress=fail))
        picture = session.render(samples=2)
    assert picture.stats["samples"] == 2


def test_threads_take_turns(reflet: ModuleType, scene: Path) -> None:
    with reflet.open(scene) as session:
        alone = [session.render(frame).display for frame in range(4)]
        found: dict[int, object] = {}

        def work(frame: int) -> None:
            found[frame] = session.render(frame).display

        threads = [threading.Thread(target=work, args=(frame,)) for frame in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert all(np.array_equal(alone[frame], found[frame]) for frame in range(4))


#: A child process that was forked tries everything, and says the classes of the errors.
FORKED = text_of("python/forked.txt")


def test_a_fork_is_refused(package: Path, scene: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", FORKED, str(scene)],
        env={**os.environ, "PYTHONPATH": str(package)},
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert done.stdout.split() == ["ForkError"] * 5 + ["7", "0"], done.stderr


def test_comparisons_equal_those_of_the_program(reflet: ModuleType, scene: Path) -> None:
    folder = scene.parent
    with reflet.open(scene) as session:
        picture = session.render(method="ssr", aovs=["reflectance"])
        reference = session.render(method="rt")
    for name, one in (("a", picture), ("b", reference)):
        one.save(folder / f"{name}.png")
    mask = folder / "a.reflectance.png"
    told = run("compare", folder / "a.png", folder / "b.png", "--mask", mask, "--json").stdout
    told = json.loads(told)
    ways = [
        (picture, reference),
        (folder / "a.png", folder / "b.png"),
        (picture.display[..., :3], reference.display),
    ]
    for a, b in ways:
        judged = reflet.compare(a, b, mask=mask)
        for own, other in ((judged, told["frame"]), (judged.mask, told["mask"]["scored"])):
            assert own.flip == pytest.approx(other["flip_mean"], abs=1e-12)
            assert own.ssim == pytest.approx(other["ssim"], abs=1e-12)
            assert own.area_px == other["area_px"]
        assert judged.flip_map.shape == (27, 48)
        assert judged.flip_map.mean() == pytest.approx(judged.flip, abs=1e-4)
        assert not judged.identical
    weights = reflet.compare(picture, reference, mask=picture["reflectance"])
    assert weights.mask.area_px == pytest.approx(told["mask"]["scored"]["area_px"], abs=3)
    assert reflet.compare(reference, reference).identical
    broken = reference.radiance.copy()
    broken[1, 2, 0] = np.nan
    for test, says in [
        (broken, "1 pixel holds NaN.*column 2, row 1"),
        (picture.display[1:], "sizes differ"),
        (picture.display[..., 0], "must have the shape"),
        (picture.display.astype(int), "not ndarray"),
        (None, "not NoneType"),
    ]:
        with pytest.raises(reflet.ArgumentError, match=says):
            reflet.compare(test, reference)
    with pytest.raises(reflet.SceneError, match="cannot be read"):
        reflet.compare(folder / "none.png", reference)


def test_wrong_hits_are_a_value(reflet: ModuleType, scene: Path) -> None:
    dull = {"material.chrome.metallic": 0, "material.chrome.reflectivity": 0}
    with reflet.open(scene, method="hybrid", set=dull) as session:
        picture = session.render(audit=True)
        assert session.render().wrong_hits is None
    audit = picture.stats["audit"]
    assert picture.wrong_hits == pytest.approx(audit["wrong"] / audit["hits"])
    assert picture.stats["passes_ms"]


def test_types_are_those_of_the_module(package: Path, tmp_path: Path) -> None:
    """mypy checks a program against the types, and stubtest the types against the module."""
    program = tmp_path / "program.py"
    program.write_text(
        "import numpy as np\n"
        "import reflet\n"
        "def depths(path: str) -> np.ndarray:\n"
        "    with reflet.open(path, set={'image.samples': 4}, variant='night') as session:\n"
        "        picture = session.render(frame=2, aovs=['depth'], method='rt')\n"
        "        for frame in session.frames('0-3', camera='main'):\n"
        "            frame.save('out.####.exr')\n"
        "        flip: float = reflet.compare(picture, picture).flip\n"
        "    session.render(method='rays')  # type: ignore[arg-type]\n"
        "    return picture['depth'] * flip\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(package), "MYPYPATH": str(package)}
    # With the options of tools/check.sh, whose cache of NumPy's types serves here too.
    (tmp_path / "mypy.ini").write_text(
        f"[mypy]\nstrict = True\npython_version = 3.11\ncache_dir = {ROOT / '.mypy_cache'}\n"
    )
    for words in (
        ["mypy", "--config-file", "mypy.ini", str(program)],
        ["mypy.stubtest", "--mypy-config-file", "mypy.ini", "reflet"],
    ):
        done = subprocess.run(
            [sys.executable, "-m", *words],
            env=environment,
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr
