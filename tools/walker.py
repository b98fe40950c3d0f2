"""Writes `scripts/walker.glb`, a walking figure with a skin and a morph target, from nothing."""

import argparse
from pathlib import Path

import numpy as np
from gltf_mutant_decoders import Buffer
from scipy.spatial.transform import Rotation

# Joints: name, parent, offset from parent in meters; the figure faces +Z, stands on y = 0. Its arms
# are spread at rest, so that hands do not pull the hips along.
JOINTS = [
    ("hips", -1, (0.0, 0.93, 0.0)),
    ("spine", 0, (0.0, 0.12, 0.0)),
    ("chest", 1, (0.0, 0.22, 0.0)),
    ("neck", 2, (0.0, 0.20, 0.0)),
    ("head", 3, (0.0, 0.10, 0.02)),
    ("shoulder.l", 2, (0.19, 0.14, 0.0)),
    ("elbow.l", 5, (0.20, -0.20, 0.0)),
    ("wrist.l", 6, (0.185, -0.185, 0.01)),
    ("shoulder.r", 2, (-0.19, 0.14, 0.0)),
    ("elbow.r", 8, (-0.20, -0.20, 0.0)),
    ("wrist.r", 9, (-0.185, -0.185, 0.01)),
    ("hip.l", 0, (0.10, -0.04, 0.0)),
    ("knee.l", 11, (0.0, -0.41, 0.01)),
    ("ankle.l", 12, (0.0, -0.40, -0.01)),
    ("hip.r", 0, (-0.10, -0.04, 0.0)),
    ("knee.r", 14, (0.0, -0.41, 0.01)),
    ("ankle.r", 15, (0.0, -0.40, -0.01)),
]
INDEX = {name: i for i, (name, _, _) in enumerate(JOINTS)}
# Round bones of the body: joint, both ends relative to that joint, radius at both ends.
BONES = [
    ("hips", (-0.06, 0.0, 0.0), (0.06, 0.0, 0.0), 0.12, 0.12),
    ("spine", (0.0, -0.02, 0.0), (0.0, 0.18, 0.0), 0.115, 0.13),
    ("chest", (-0.07, 0.06, 0.0), (0.07, 0.06, 0.0), 0.125, 0.125),
    ("neck", (0.0, -0.04, 0.0), (0.0, 0.08, 0.01), 0.055, 0.05),
    ("head", (0.0, 0.04, 0.01), (0.0, 0.13, 0.0), 0.085, 0.10),
    ("shoulder.l", (0.0, 0.0, 0.0), (0.20, -0.20, 0.0), 0.06, 0.045),
    ("elbow.l", (0.0, 0.0, 0.0), (0.185, -0.185, 0.01), 0.045, 0.035),
    ("wrist.l", (0.015, -0.015, 0.0), (0.08, -0.08, 0.01), 0.036, 0.03),
    ("shoulder.r", (0.0, 0.0, 0.0), (-0.20, -0.20, 0.0), 0.06, 0.045),
    ("elbow.r", (0.0, 0.0, 0.0), (-0.185, -0.185, 0.01), 0.045, 0.035),
    ("wrist.r", (-0.015, -0.015, 0.0), (-0.08, -0.08, 0.01), 0.036, 0.03),
    ("hip.l", (0.0, 0.0, 0.0), (0.0, -0.41, 0.01), 0.085, 0.06),
    ("knee.l", (0.0, 0.0, 0.0), (0.0, -0.40, -0.01), 0.06, 0.042),
    ("ankle.l", (0.0, -0.03, -0.02), (0.0, -0.04, 0.15), 0.042, 0.036),
    ("hip.r", (0.0, 0.0, 0.0), (0.0, -0.41, 0.01), 0.085, 0.06),
    ("knee.r", (0.0, 0.0, 0.0), (0.0, -0.40, -0.01), 0.06, 0.042),
    ("ankle.r", (0.0, -0.03, -0.02), (0.0, -0.04, 0.15), 0.042, 0.036),
]
CELL_M = 0.036
BLEND_M = 0.03
CYCLE_S = 1.1
KEYS = 24


def bind_positions() -> np.ndarray:
    """World positions of the joints at rest."""
    places = np.zeros((len(JOINTS), 3))
    for i, (_, parent, offset) in enumerate(JOINTS):
        places[i] = np.array(offset) + (places[parent] if parent >= 0 else 0.0)
    return places


def distances(points: np.ndarray) -> np.ndarray:
    """Signed distance of each point to each bone."""
    places = bind_positions()
    out = np.empty((len(points), len(BONES)))
    for i, (joint, start, end, r0, r1) in enumerate(BONES):
        a, b = places[INDEX[joint]] + start, places[INDEX[joint]] + end
        along = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
        radius = r0 + (r1 - r0) * along
        out[:, i] = np.linalg.norm(points - a - along[:, None] * (b - a), axis=1) - radius
    return out


def body(points: np.ndarray) -> np.ndarray:
    """Signed distance of each point to the body: a smooth minimum over the bones."""
    near = np.exp(-np.clip(distances(points), -0.5, 0.5) / BLEND_M)
    return -BLEND_M * np.log(near.sum(axis=1))


def surface() -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of the body's surface, by surface nets (Gibson 1998)."""
    low, high = np.array([-0.78, -0.05, -0.22]), np.array([0.78, 1.85, 0.30])
    size = np.ceil((high - low) / CELL_M).astype(int) + 1
    grid = np.stack(np.meshgrid(*[np.arange(n) for n in size], indexing="ij"), axis=-1)
    values = body(low + grid.reshape(-1, 3) * CELL_M).reshape(size)
    inside = values < 0.0
    sums, counts = np.zeros((*(size - 1), 3)), np.zeros(size - 1)
    corners = [np.array([k >> 2 & 1, k >> 1 & 1, k & 1]) for k in range(8)]
    for a in corners:
        for axis in range(3):
            if a[axis]:
                continue
            b = a + np.eye(3, dtype=int)[axis]
            va, vb = (
                values[tuple(slice(c[i], c[i] + size[i] - 1) for i in range(3))] for c in (a, b)
            )
            crosses = (va < 0.0) != (vb < 0.0)
            share = np.where(crosses, va / np.where(crosses, va - vb, 1.0), 0.0)
            at = a + share[..., None] * (b - a)
            sums += np.where(crosses[..., None], at, 0.0)
            counts += crosses
    used = counts > 0
    number = np.full(used.shape, -1)
    number[used] = np.arange(used.sum())
    cells = np.argwhere(used)
    vertices = low + (cells + sums[used] / counts[used][:, None]) * CELL_M
    triangles: list[tuple[int, int, int]] = []
    for axis in range(3):
        u, v = (np.eye(3, dtype=int)[(axis + k) % 3] for k in (1, 2))
        first = inside[tuple(slice(0, n - (i == axis)) for i, n in enumerate(size))]
        second = inside[tuple(slice(int(i == axis), n) for i, n in enumerate(size))]
        for edge in np.argwhere(first != second):
            a, b, c, d = (number[tuple(edge - back)] for back in (u + v, v, 0 * u, u))
            quad = (a, b, c, d) if first[tuple(edge)] else (a, d, c, b)
            triangles += [(quad[0], quad[1], quad[2]), (quad[0], quad[2], quad[3])]
    return vertices, np.array(triangles)


def normals_at(points: np.ndarray) -> np.ndarray:
    """Normals: the gradient of the distance."""
    step = 1e-4
    columns = [body(points + step * e) - body(points - step * e) for e in np.eye(3)]
    normals = np.stack(columns, axis=1)
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def influences(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Four joints of each point and their weights, in steps of 1 / 255."""
    near = 1.0 / np.maximum(distances(points) + 0.05, 0.01) ** 6
    joints = np.argsort(-near, axis=1)[:, :4]
    weights = np.take_along_axis(near, joints, axis=1)
    steps = np.round(weights / weights.sum(axis=1, keepdims=True) * 255.0).astype(int)
    steps[:, 0] += 255 - steps.sum(axis=1)
    owners = np.array([INDEX[bone[0]] for bone in BONES])
    return np.where(steps > 0, owners[joints], 0), steps


def about(axis: str, angle: float) -> Rotation:
    """Turn about an axis by an angle in radians."""
    return Rotation.from_euler(axis, angle)


def step_pose(phase: float) -> dict[str, Rotation]:
    """Rotations of the joints at a phase of the walk; the left foot is in front at 0."""
    pose = {
        "spine": about("y", 0.07 * np.cos(phase)),
        "chest": about("y", -0.16 * np.cos(phase)),
        "head": about("y", 0.08 * np.cos(phase)),
    }
    for side, lead in (("l", phase), ("r", phase + np.pi)):
        swing = np.cos(lead)
        # The knee bends while its foot travels forward.
        lift = max(0.0, -np.sin(lead)) ** 1.5
        pose[f"hip.{side}"] = about("x", -0.48 * swing - 0.25 * lift)
        pose[f"knee.{side}"] = about("x", 0.10 + 0.85 * lift)
        pose[f"ankle.{side}"] = about("x", 0.30 * swing - 0.15)
        # The arms hang, and swing against the legs.
        lower = about("z", (-0.72 if side == "l" else 0.72))
        bend = about("x", -0.30 - 0.22 * max(0.0, -swing))
        pose[f"shoulder.{side}"] = about("x", 0.42 * swing) * lower
        pose[f"elbow.{side}"] = lower.inv() * bend * lower
    return pose


def lowest(pose: dict[str, Rotation]) -> float:
    """Height of the lower foot's lowest point, in meters relative to the hips."""
    frames: list[tuple[np.ndarray, np.ndarray]] = []
    for name, parent, offset in JOINTS:
        up, at = frames[parent] if parent >= 0 else (np.eye(3), np.zeros(3))
        turn = pose[name].as_matrix() if name in pose else np.eye(3)
        frames.append((up @ turn, at + up @ np.array(offset)))
    lows = []
    for joint, start, end, r0, r1 in BONES:
        if joint.startswith("ankle"):
            turn, at = frames[INDEX[joint]]
            lows += [(at + turn @ np.array(p))[1] - r for p, r in ((start, r0), (end, r1))]
    return min(lows)


class Writer(Buffer):
    """Collects accessors of a GLB, each with rows of whole words."""

    def add(self, kind: str, code: int, values: np.ndarray, **more: object) -> int:
        types = {5121: "u1", 5123: "<u2", 5120: "i1", 5122: "<i2", 5126: "<f4"}
        array = np.ascontiguousarray(values.astype(types[code]))
        stride: dict[str, int] = {}
        if array.ndim == 2 and array.shape[1] * array.itemsize % 4:
            padded = np.zeros((len(array), -(-array.shape[1] * array.itemsize // 4) * 4), "u1")
            padded[:, : array.shape[1] * array.itemsize] = array.view("u1").reshape(len(array), -1)
            stride = {"byteStride": padded.shape[1]}
            array = padded
        return self.accessor(self.view(array.tobytes(), **stride), kind, code, len(values), **more)


def animation(out: Writer) -> dict:
    """Add the walk as one animation cycle: rotations, height of the hips, and the breath."""
    times = np.linspace(0.0, CYCLE_S, KEYS + 1)
    phases = times / CYCLE_S * 2.0 * np.pi
    poses = [step_pose(phase) for phase in phases]
    key = out.add("SCALAR", 5126, times, min=[0.0], max=[float(np.float32(CYCLE_S))])
    samplers: list[dict] = []
    channels: list[dict] = []

    def channel(node: int, path: str, output: int) -> None:
        channels.append({"sampler": len(samplers), "target": {"node": node, "path": path}})
        samplers.append({"input": key, "output": output})

    for name in poses[0]:
        turns = np.round(np.array([pose[name].as_quat() for pose in poses]) * 32767.0)
        output = out.add("VEC4", 5122, turns, normalized=True)
        channel(1 + INDEX[name], "rotation", output)
    # The lower foot is always on the floor.
    heights = [JOINTS[0][2][1] - lowest(pose) for pose in poses]
    places = np.array([[0.0, height, 0.0] for height in heights])
    channel(1, "translation", out.add("VEC3", 5126, places))
    breath = 0.5 - 0.5 * np.cos(2.0 * phases)
    channel(0, "weights", out.add("SCALAR", 5126, breath))
    return {"name": "walk", "samplers": samplers, "channels": channels}


def stride_m() -> float:
    """Length of one cycle's way in meters: how far the foot on the floor moves back."""
    reach = sum(abs(JOINTS[INDEX[n]][2][1]) for n in ("knee.l", "ankle.l")) + 0.07
    return 4.0 * reach * float(np.sin(0.48)) * 0.93


def figure() -> bytes:
    """Bytes of the whole .glb file."""
    vertices, triangles = surface()
    joints, weights = influences(vertices)
    places = bind_positions()
    out = Writer()
    bound = {
        "min": vertices.min(0).astype("f4").tolist(),
        "max": vertices.max(0).astype("f4").tolist(),
    }
    chest = np.exp(-(((vertices - places[INDEX["chest"]] - (0, 0.05, 0.1)) / 0.14) ** 2)).prod(1)
    offset = normals_at(vertices) * (chest * 0.025)[:, None]
    swell = {"min": offset.min(0).astype("f4").tolist(), "max": offset.max(0).astype("f4").tolist()}
    bind = np.tile(np.eye(4), (len(JOINTS), 1, 1))
    bind[:, 3, :3] = -places  # glTF stores columns first
    primitive = {
        "attributes": {
            "POSITION": out.add("VEC3", 5126, vertices, **bound),
            "NORMAL": out.add("VEC3", 5120, np.round(normals_at(vertices) * 127), normalized=True),
            "JOINTS_0": out.add("VEC4", 5121, joints),
            "WEIGHTS_0": out.add("VEC4", 5121, weights, normalized=True),
        },
        "targets": [{"POSITION": out.add("VEC3", 5126, offset, **swell)}],
        "indices": out.add("SCALAR", 5123, triangles.ravel()),
        "material": 0,
    }
    nodes: list[dict] = [{"name": "body", "mesh": 0, "skin": 0}]
    for i, (name, _, offset_m) in enumerate(JOINTS):
        children = [1 + k for k, (_, parent, _) in enumerate(JOINTS) if parent == i]
        node = {"name": name, "translation": list(offset_m)}
        nodes.append(node | ({"children": children} if children else {}))
    inverse = out.add("MAT4", 5126, bind.reshape(-1, 16))
    root = {
        "asset": {
            "version": "2.0",
            "generator": "tools/walker.py",
            "extras": {"strideM": round(stride_m(), 3), "cycleS": CYCLE_S},
        },
        "extensionsUsed": ["KHR_mesh_quantization"],
        "extensionsRequired": ["KHR_mesh_quantization"],
        "scene": 0,
        "scenes": [{"nodes": [0, 1]}],
        "nodes": nodes,
        "meshes": [
            {
                "name": "body",
                "primitives": [primitive],
                "extras": {"targetNames": ["breath"]},
            }
        ],
        "materials": [
            {
                "name": "body",
                "pbrMetallicRoughness": {
                    "baseColorFactor": [0.8, 0.45, 0.2, 1],
                    "metallicFactor": 0,
                    "roughnessFactor": 0.45,
                },
            }
        ],
        "skins": [{"joints": list(range(1, 1 + len(JOINTS))), "inverseBindMatrices": inverse}],
        "animations": [animation(out)],
    }
    return out.glb(root, (",", ":"))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    default = Path(__file__).parent.parent / "scripts" / "walker.glb"
    parser.add_argument("output", nargs="?", type=Path, default=default)
    path = parser.parse_args().output
    path.write_bytes(figure())
    print(f"{path}: {path.stat().st_size} bytes, {stride_m():.3f} m in {CYCLE_S} s")


if __name__ == "__main__":
    main()
