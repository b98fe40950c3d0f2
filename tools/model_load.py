"""Compares loading and showing large glTF files: reflet, f3d and trimesh, each in its own process.

python3 -m venv /tmp/viewers && /tmp/viewers/bin/pip install f3d trimesh numpy pillow
.venv/bin/python tools/model_load.py --viewers /tmp/viewers/bin/python -o docs/data/model-load.csv

Measures processor time and peak memory of each process, which other work on the machine changes
little, and wall-clock time. f3d draws to an off-screen window, trimesh only loads. Pipelines that
models need are compiled before.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from gltf_mutant_decoders import Buffer
from measuring import add_program, program_of, used
from tables import Rows, read_rows, write_rows

F3D = """
import sys, f3d
f3d.Log.set_verbose_level(f3d.Log.QUIET)
engine = f3d.Engine.create(True)
engine.window.size = 256, 256
engine.scene.add(sys.argv[1])
engine.window.render_to_image().save(sys.argv[2])
"""
TRIMESH = "import sys, trimesh; trimesh.load(sys.argv[1])"


class Writer(Buffer):
    """Builder of a .glb of meshes with positions, normals and indices."""

    def __init__(self) -> None:
        super().__init__()
        self.root: dict = {"scene": 0, "meshes": [], "nodes": []}

    def add(self, values: np.ndarray, kind: str, component: int) -> int:
        bounds = {"min": values.min(0).tolist(), "max": values.max(0).tolist()}
        more = bounds if kind == "VEC3" else {}
        return self.accessor(self.view(values.tobytes()), kind, component, len(values), **more)

    def ball(self) -> None:
        """Add an octahedron with each face cut in four: 32 triangles."""
        axes = np.concatenate([np.eye(3), -np.eye(3)])
        upper = [(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2)]
        faces = [*upper, *((b, a, 5) for a, b, _ in upper)]
        parts = []
        for a, b, c in (axes[list(face)] for face in faces):
            ab, bc, ca = a + b, b + c, c + a
            parts += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        points = np.array(parts).reshape(-1, 3)
        points = (points / np.linalg.norm(points, axis=-1, keepdims=True)).astype("f4")
        points, indices = np.unique(points.round(6), axis=0, return_inverse=True)
        attributes = {"POSITION": self.add(points, "VEC3", 5126)}
        attributes["NORMAL"] = self.add(points.copy(), "VEC3", 5126)
        corners = self.add(indices.astype("u4").reshape(-1), "SCALAR", 5125)
        self.root["meshes"].append({"primitives": [{"attributes": attributes, "indices": corners}]})

    def mesh(self, side: int, seed: int, material: int | None = None) -> None:
        """Add a wavy square of 2 (side - 1)² triangles."""
        x, z = np.meshgrid(np.linspace(-1, 1, side), np.linspace(-1, 1, side))
        y = 0.1 * np.sin(9 * x + seed) * np.cos(7 * z)
        points = np.stack([x, y, z], -1).reshape(-1, 3).astype("f4")
        up = np.stack([-0.9 * np.cos(9 * x + seed) * np.cos(7 * z), np.ones_like(x), 0 * x], -1)
        up = (up / np.linalg.norm(up, axis=-1, keepdims=True)).reshape(-1, 3).astype("f4")
        corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).reshape(-1, 1)
        quads = corner + np.array([0, side, 1, 1, side, side + 1])
        attributes = {"POSITION": self.add(points, "VEC3", 5126)}
        attributes["NORMAL"] = self.add(up, "VEC3", 5126)
        if material is not None:
            uv = np.stack([x, z], -1).reshape(-1, 2).astype("f4")
            attributes["TEXCOORD_0"] = self.add(uv, "VEC2", 5126)
        indices = self.add(quads.astype("u4").reshape(-1), "SCALAR", 5125)
        primitive = {"attributes": attributes, "indices": indices}
        if material is not None:
            primitive["material"] = material
        self.root["meshes"].append({"primitives": [primitive]})

    def node(self, mesh: int, place: tuple[float, float, float]) -> None:
        self.root["nodes"].append({"mesh": mesh, "translation": list(place)})

    def write(self, path: Path) -> None:
        # Materials of glTF are metals by default, which reflect even if they are rough.
        materials = self.root.setdefault("materials", [{"pbrMetallicRoughness": {}}])
        for material in materials:
            material["pbrMetallicRoughness"]["metallicFactor"] = 0
        for mesh in self.root["meshes"]:
            mesh["primitives"][0].setdefault("material", 0)
        scene = {"nodes": list(range(len(self.root["nodes"])))}
        path.write_bytes(self.glb(self.root | {"scenes": [scene]}))


def triangles(millions: float, path: Path) -> None:
    out = Writer()
    out.mesh(round((millions * 5e5) ** 0.5) + 1, 0)
    out.node(0, (0, 0, 0))
    out.write(path)


def meshes(path: Path) -> None:
    out = Writer()
    for i in range(10_000):
        out.mesh(8, i)
        out.node(i, (2.2 * (i % 100), 0, 2.2 * (i // 100)))
    out.write(path)


def textures(path: Path) -> None:
    from io import BytesIO

    from PIL import Image

    out = Writer()
    random = np.random.default_rng(1)
    out.root |= {"images": [], "textures": [], "materials": []}
    for i in range(200):
        small = random.integers(0, 255, (32, 32, 3), dtype=np.uint8)
        raw = BytesIO()
        Image.fromarray(small).resize((1024, 1024)).save(raw, "JPEG")
        view = out.view(raw.getvalue())
        out.root["images"].append({"bufferView": view, "mimeType": "image/jpeg"})
        out.root["textures"].append({"source": i})
        pbr = {"baseColorTexture": {"index": i}}
        out.root["materials"].append({"pbrMetallicRoughness": pbr})
        out.mesh(8, i, i)
        out.node(i, (2.2 * (i % 20), 0, 2.2 * (i // 20)))
    out.write(path)


def measured(command: list[str]) -> dict[str, str]:
    """Wall-clock and processor seconds, peak memory in MiB, and exit status of a command."""
    ran = used(command)
    times = {"wall_s": f"{ran.wall_s:.2f}", "processor_s": f"{ran.processor_s:.2f}"}
    return times | {"memory_mib": f"{ran.memory_mib:.0f}", "exit": str(ran.code)}


def points(millions: float, path: Path) -> None:
    out = Writer()
    random = np.random.default_rng(1)
    count = round(millions * 1e6)
    places = out.add(random.normal(size=(count, 3)).astype("f4"), "VEC3", 5126)
    opaque = random.integers(0, 256, (count, 4), dtype="u1") | np.array([0, 0, 0, 255], "u1")
    colors = out.add(opaque, "VEC4", 5121)
    out.accessors[colors]["normalized"] = True
    attributes = {"POSITION": places, "COLOR_0": colors}
    out.root["meshes"].append({"primitives": [{"attributes": attributes, "mode": 0}]})
    out.node(0, (0, 0, 0))
    out.write(path)


def grid() -> np.ndarray:
    """A million places."""
    k = np.arange(1_000_000)
    return (3 * np.stack([k % 100, k // 100 % 100, k // 10_000], -1)).astype("f4")


def instances(path: Path) -> None:
    out = Writer()
    out.ball()
    name = "EXT_mesh_gpu_instancing"
    placed = {name: {"attributes": {"TRANSLATION": out.add(grid(), "VEC3", 5126)}}}
    out.root |= {"extensionsUsed": [name], "nodes": [{"mesh": 0, "extensions": placed}]}
    out.write(path)


def nodes(path: Path) -> None:
    out = Writer()
    out.ball()
    for place in grid().tolist():
        out.node(0, place)
    out.write(path)


MAKERS = {
    "1 M triangles": lambda path: triangles(1, path),
    "5 M triangles": lambda path: triangles(5, path),
    "10 M triangles": lambda path: triangles(10, path),
    "10,000 meshes": meshes,
    "200 textures": textures,
    "1 M points": lambda path: points(1, path),
    "3 M points": lambda path: points(3, path),
    "10 M points": lambda path: points(10, path),
    "1 M instances": instances,
    "1 M nodes": nodes,
}


def main() -> None:
    if sys.argv[1:2] == ["make"]:
        MAKERS[sys.argv[2]](Path(sys.argv[3]))
        return
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--viewers", default="python3", help="a Python with f3d and trimesh")
    add_program(parser)
    parser.add_argument(
        "--only", default="", help="models whose name contains this; other rows of the file stay"
    )
    parser.add_argument("-o", "--out", type=Path, required=True)
    arguments = parser.parse_args()
    program = str(program_of(arguments.reflet))
    rows: Rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name in MAKERS:
            if arguments.only not in name:
                continue
            model, picture = Path(folder) / "model.glb", str(Path(folder) / "out.png")
            # A child's peak memory begins at the size of this process, which must stay small.
            subprocess.run([sys.executable, __file__, "make", name, str(model)], check=True)
            render = [program, "render", str(model), "-o", picture, "--size", "256x256"]
            shiny = 'model.model.material."*"={ metallic = 1, roughness = 0 }'
            for tool, command in {
                "reflet": render,
                "reflet, reflective": [*render, "--set", shiny],
                "f3d": [arguments.viewers, "-c", F3D, str(model), picture],
                "trimesh, loads only": [arguments.viewers, "-c", TRIMESH, str(model)],
            }.items():
                if tool.startswith("reflet") and not rows[1:]:
                    measured(command)  # fills the driver's cache of compiled shaders
                rows.append({"model": name, "tool": tool} | measured(command))
                print(", ".join(rows[-1].values()), flush=True)
    now = {row["model"] for row in rows}
    rows += [row for row in read_rows(arguments.out) if row["model"] not in now]
    rows.sort(key=lambda row: list(MAKERS).index(row["model"]))
    write_rows(arguments.out, rows)


if __name__ == "__main__":
    main()
