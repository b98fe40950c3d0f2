"""Owns small glTF files that the tests write by hand, through pygltflib, for the validator."""

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pygltflib as gl


@dataclasses.dataclass
class HandMesh:
    """Arrays of one triangle primitive."""

    positions: Any
    triangles: Any
    normals: Any = None
    uvs: Any = None
    material: int | None = None


class HandFile:
    """Collects nodes, meshes and materials and writes one .glb."""

    def __init__(self) -> None:
        self.gltf = gl.GLTF2(
            asset=gl.Asset(version="2.0"), scene=0, scenes=[gl.Scene(nodes=[])], extensionsUsed=[]
        )
        self.data = bytearray()

    def accessor(self, values: Any, kind: str, dtype: Any, target: int | None = None) -> int:
        """Append an array; returns the index of its accessor."""
        array = np.ascontiguousarray(values, dtype=dtype)
        while len(self.data) % 4:
            self.data.append(0)
        view = gl.BufferView(
            buffer=0, byteOffset=len(self.data), byteLength=array.nbytes, target=target
        )
        self.data += array.tobytes()
        self.gltf.bufferViews.append(view)
        component = {"f": gl.FLOAT, "u": gl.UNSIGNED_INT}[array.dtype.kind]
        flat = array.reshape(len(array), -1)
        self.gltf.accessors.append(
            gl.Accessor(
                bufferView=len(self.gltf.bufferViews) - 1,
                componentType=component,
                count=len(array),
                type=kind,
                min=flat.min(0).tolist(),
                max=flat.max(0).tolist(),
            )
        )
        return len(self.gltf.accessors) - 1

    def mesh(self, mesh: HandMesh) -> int:
        """Append a mesh of one primitive; returns its index."""
        attributes = gl.Attributes()
        attributes.POSITION = self.accessor(mesh.positions, "VEC3", np.float32, 34962)
        if mesh.normals is not None:
            attributes.NORMAL = self.accessor(mesh.normals, "VEC3", np.float32, 34962)
        if mesh.uvs is not None:
            attributes.TEXCOORD_0 = self.accessor(mesh.uvs, "VEC2", np.float32, 34962)
        indices = np.asarray(mesh.triangles).reshape(-1)
        primitive = gl.Primitive(
            attributes=attributes,
            indices=self.accessor(indices, "SCALAR", np.uint32, 34963),
            material=mesh.material,
        )
        self.gltf.meshes.append(gl.Mesh(primitives=[primitive]))
        return len(self.gltf.meshes) - 1

    def node(self, prim: str, parent: int | None = None, **values: Any) -> int:
        """Append a node that keeps `prim` in its extras; returns its index."""
        self.gltf.nodes.append(gl.Node(extras={"prim": prim}, **values))
        index = len(self.gltf.nodes) - 1
        siblings = self.gltf.scenes[0] if parent is None else self.gltf.nodes[parent]
        if parent is None:
            siblings.nodes.append(index)
        else:
            siblings.children = [*(siblings.children or []), index]
        return index

    def material(self, prim: str, **values: Any) -> int:
        """Append a material that keeps `prim` in its extras; returns its index."""
        self.gltf.materials.append(gl.Material(extras={"prim": prim}, **values))
        return len(self.gltf.materials) - 1

    def write(self, path: Path) -> Path:
        """Write the file and return its path."""
        self.gltf.buffers = [gl.Buffer(byteLength=len(self.data))] if self.data else []
        if self.data:
            self.gltf.set_binary_blob(bytes(self.data))
        self.gltf.save(str(path))
        return path
