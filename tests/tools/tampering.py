"""Owns functions that damage converted files, and the check that the validator finds the damage."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pygltflib as gl
from material_stages import noise, save
from read_converted import Converted, convert_text
from reflet_usd.validate.validation_table import format_validation
from texts import text_of

FACE = text_of("tampering/face.usda")
UVS = text_of("tampering/uvs.usda")
NORMALS = text_of("tampering/normals.usda")
Damage = Callable[["Output"], None]
Case = tuple[str, str, str, Damage]
"""Name of a damaged stage, its text, the warning that it has (or none), and the damage."""


class Output:
    """A converted .glb file, loaded so that a test can damage it."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.gltf = gl.GLTF2().load(str(path))
        self.blob = bytearray(self.gltf.binary_blob() or b"")

    def rewrite(self, accessor: int, change: Callable[[np.ndarray], np.ndarray]) -> None:
        """Change the values of a float accessor in place."""
        entry = self.gltf.accessors[accessor]
        view = self.gltf.bufferViews[entry.bufferView]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[entry.type]
        start = (view.byteOffset or 0) + (entry.byteOffset or 0)
        values = np.frombuffer(self.blob, np.float32, entry.count * width, start)
        changed = change(values.reshape(-1, width).copy()).astype(np.float32)
        self.blob[start : start + changed.nbytes] = changed.tobytes()
        if entry.min is not None:
            entry.min, entry.max = changed.min(0).tolist(), changed.max(0).tolist()

    def attributes(self, name: str) -> list[int]:
        """Accessor indices of one attribute over all primitives."""
        found = {
            getattr(primitive.attributes, name)
            for mesh in self.gltf.meshes
            for primitive in mesh.primitives
        }
        return sorted(found - {None})

    def save(self) -> None:
        """Write the damaged file over the original."""
        self.gltf.set_binary_blob(bytes(self.blob))
        self.gltf.save_binary(str(self.path))


def lose(prim: str) -> Damage:
    """Damage: remove mesh, camera and extensions of all nodes at or below the prim."""

    def damage(out: Output) -> None:
        hit = [n for n in out.gltf.nodes if (n.extras or {}).get("prim", "").startswith(prim)]
        assert hit
        for node in hit:
            node.mesh = node.camera = node.extensions = None

    return damage


def change(name: str, how: Callable[[np.ndarray], np.ndarray]) -> Damage:
    """Damage: change the values of one attribute in all meshes."""

    def damage(out: Output) -> None:
        found = out.attributes(name)
        assert found
        for accessor in found:
            out.rewrite(accessor, how)

    return damage


grow = change("POSITION", lambda values: values * 9)
turn_normals = change("NORMAL", lambda values: values[:, [1, 2, 0]])
move_uvs = change("TEXCOORD_0", lambda values: values * 5 + 3)


def place(out: Output) -> None:
    """Damage: move all nodes with a mesh or a camera to another place."""
    for node in out.gltf.nodes:
        if node.mesh is not None or node.camera is not None:
            node.translation = [7.0, 7.0, 7.0]


def animate(out: Output) -> None:
    """Damage: change the values of all animation keys."""
    for sampler in out.gltf.animations[0].samplers:
        out.rewrite(sampler.output, lambda values: values + 0.2)


def triangles(how: Callable[[np.ndarray], np.ndarray]) -> Damage:
    """Damage: replace the triangles of each primitive by as many or fewer."""

    def damage(out: Output) -> None:
        for primitive in (primitive for mesh in out.gltf.meshes for primitive in mesh.primitives):
            entry = out.gltf.accessors[primitive.indices]
            view = out.gltf.bufferViews[entry.bufferView]
            kind = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32}[entry.componentType]
            start = (view.byteOffset or 0) + (entry.byteOffset or 0)
            old = np.frombuffer(out.blob, kind, entry.count, start).reshape(-1, 3)
            new = how(old.copy()).astype(kind)
            out.blob[start : start + new.nbytes] = new.tobytes()
            entry.count = new.size

    return damage


turn = triangles(lambda old: old[:, ::-1])


def look(**values: Any) -> Damage:
    """Damage: change fields of the first material's pbrMetallicRoughness."""

    def damage(out: Output) -> None:
        for name, value in values.items():
            setattr(out.gltf.materials[0].pbrMetallicRoughness, name, value)

    return damage


def hide_colors(out: Output) -> None:
    """Damage: change the base color of the last material."""
    out.gltf.materials[-1].pbrMetallicRoughness.baseColorFactor = [0.0, 1.0, 1.0, 1.0]


def light(**values: Any) -> Damage:
    """Damage: change fields of the first light."""

    def damage(out: Output) -> None:
        out.gltf.extensions["KHR_lights_punctual"]["lights"][0].update(values)

    return damage


def zoom(out: Output) -> None:
    """Damage: change the camera's field of view."""
    out.gltf.cameras[0].perspective.yfov *= 0.3


def clip(out: Output) -> None:
    """Damage: change the camera's near plane."""
    out.gltf.cameras[0].perspective.znear *= 0.5


def mesh(name: str, body: str = "", api: str = "") -> str:
    """Scene text of a quad mesh."""
    schemas = f' (prepend apiSchemas = ["{api}"])' if api else ""
    return f'def Mesh "{name}"{schemas}\n{{{FACE}{body}}}\n'


UNIT = mesh(
    "Unit",
    'double3 xformOp:translate = (4, 0, 0)\nuniform token[] xformOpOrder = ["xformOp:translate"]\n',
)


def expect_found(done: Converted, damage: Damage) -> None:
    """Assert that the file passes as it is, and fails once damaged."""
    validation = done.validated()
    assert validation.passed, format_validation(validation)
    output = Output(done.out)
    damage(output)
    output.save()
    assert not done.validated().passed


def expect_case(folder: Path, case: Case) -> None:
    """Assert that a stage has its warning, if any, which excuses nothing of the damage."""
    _, text, warning, damage = case
    save(folder, "t.png", noise("RGB", (16, 16)))
    save(folder, "small.png", noise("RGB", (8, 8), seed=3))
    done = convert_text(folder, text)
    assert not warning or warning in done.warnings()
    expect_found(done, damage)


def expect_required(done: Converted, warning: str, prim: str, *named: str) -> None:
    """Assert that the warning names all it must, and that the file passes only with it."""
    found = [w for w in done.sidecar["warnings"] if (w["name"], w["prim"]) == (warning, prim)]
    told = " ".join(entry["message"] for entry in found)
    assert found
    assert [name for name in named if f"'{name}'" not in told] == []
    validation = done.validated()
    assert validation.passed, format_validation(validation)
    kept = [entry for entry in done.sidecar["warnings"] if entry not in found]
    place = Path(f"{done.out}.json")
    place.write_text(json.dumps({**done.sidecar, "warnings": kept}), encoding="utf-8")
    assert not done.validated().passed
    place.write_text(json.dumps(done.sidecar), encoding="utf-8")
