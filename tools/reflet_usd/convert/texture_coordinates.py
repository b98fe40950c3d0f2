"""Texture coordinates of MaterialX images: a UV set and one affine transform of it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from pxr import UsdShade

from .context import in_float32, producer
from .scene import Array
from .sources import UnfitError, UvRead

if TYPE_CHECKING:
    from .node_values import NodeValues

_MOST_STEPS = 64
# Columns of the transform count as perpendicular within this share of their lengths.
_SQUARE = 1e-6


def coordinates(
    values: NodeValues, image: UsdShade.Shader, operation: str, name: str = "texcoord"
) -> UvRead:
    """Coordinates of an image node's input; what cannot be followed is named, taken as `st`."""
    warn = values.reader.context.ledger.warn
    try:
        with np.errstate(over="ignore", invalid="ignore"):  # judged below
            matrix = _own_transform(values, image, operation)
            uv, matrix = _followed(values, image, name, matrix)
    except UnfitError as error:
        kind = error.node.GetIdAttr().Get()
        message = f"texture coordinates come from the node {kind}: {error}; taken as 'st'"
        warn("material-unsupported", error.node.GetPrim(), message)
        return UvRead()
    if not in_float32(matrix).all():
        warn("uv-transform-dropped", image.GetPrim(), "its coordinates are not finite, taken plain")
        return uv
    first, last = matrix[:2, 0], matrix[:2, 1]
    lengths = float(np.linalg.norm(first)), float(np.linalg.norm(last))
    if abs(float(first @ last)) > _SQUARE * lengths[0] * lengths[1]:
        warn("uv-transform-dropped", image.GetPrim(), "its coordinates shear, taken as they are")
        return uv
    angle = math.atan2(first[1], first[0]) if lengths[0] > 0.0 else 0.0
    height = float(last @ (-math.sin(angle), math.cos(angle)))
    return replace(
        uv,
        scale=(lengths[0], height),
        rotation_deg=math.degrees(angle),
        translation=(float(matrix[0, 2]), float(matrix[1, 2])),
    )


def _own_transform(values: NodeValues, node: UsdShade.Shader, operation: str) -> Array:
    """Transform by an image node's own inputs, (3, 3) for column vectors (u, v, 1)."""
    if operation == "tiledimage":
        # uv · tiling − offset, in units of the image's size in the world
        image, tile = (
            np.array(values.constant(node, f"realworld{name}size", (1.0, 1.0)))
            for name in ("image", "tile")
        )
        scale = _scaled(np.array(values.constant(node, "uvtiling", (1.0, 1.0))))
        moved = _moved(-np.array(values.constant(node, "uvoffset", (0.0, 0.0))))
        return _scaled(_divided(values, node, tile, image)) @ moved @ scale
    if operation.startswith("gltf_"):
        # place2d with the inverse scale, rotation and offset
        scale = np.array(values.constant(node, "scale", (1.0, 1.0)))
        offset = np.array(values.constant(node, "offset", (0.0, 0.0))) * (-1.0, 1.0)
        turn = -values.constant(node, "rotate", (0.0,))[0]
        return _placed(values, node, (0.0, 1.0), scale, turn, offset)
    return np.eye(3)


def _followed(
    values: NodeValues, node: UsdShade.Shader, name: str, matrix: Array
) -> tuple[UvRead, Array]:
    """The UV set behind a node's coordinates, and the transform from it; raises UnfitError."""
    for _ in range(_MOST_STEPS):
        attribute, is_output = producer(node, name)
        if attribute is None:
            return UvRead(), matrix
        if not is_output:
            fixed = values.constant(node, name, (0.0, 0.0))
            return UvRead(primvar="", fallback=(fixed[0], fixed[1])), matrix
        node = UsdShade.Shader(attribute.GetPrim())
        values.reader.visit(node)
        kind = str(node.GetIdAttr().Get() or "").removeprefix("ND_")
        end = end_of_coordinates(values, node, kind)
        if end is not None:
            return end, matrix
        step, name = step_of_coordinates(values, node, kind)
        matrix = matrix @ step
    raise UnfitError(node, f"there are more than {_MOST_STEPS} nodes before the image")


def end_of_coordinates(values: NodeValues, node: UsdShade.Shader, kind: str) -> UvRead | None:
    """The UV set that a node reads; None for nodes that change coordinates."""
    if kind.startswith("texcoord"):
        index = int(values.constant(node, "index", (0.0,))[0])
        return UvRead(primvar=f"st{index}" if index else "st")
    if kind.startswith(("geompropvalue", "UsdPrimvarReader")):
        reads_primvar = kind.startswith("Usd")
        name = values.reader.value(node, "varname" if reads_primvar else "geomprop", "st")
        fixed = values.constant(node, "fallback" if reads_primvar else "default", (0.0, 0.0))
        return UvRead(primvar=str(name or "st"), fallback=(fixed[0], fixed[1]))
    return None


def step_of_coordinates(values: NodeValues, node: UsdShade.Shader, kind: str) -> tuple[Array, str]:
    """Transform of a node that changes coordinates, and the input that it changes."""

    def pair(name: str, default: float) -> Array:
        return np.array(values.constant(node, name, (default, default)))

    if kind.startswith("place2d"):
        scale = _divided(values, node, np.ones(2), pair("scale", 1.0))
        turn = values.constant(node, "rotate", (0.0,))[0]
        return _placed(values, node, (0.0, 0.0), scale, turn, pair("offset", 0.0)), "texcoord"
    if kind == "UsdTransform2d":
        turn = values.constant(node, "rotation", (0.0,))[0]
        scaled = _turned(-turn) @ _scaled(pair("scale", 1.0))
        return _moved(pair("translation", 0.0)) @ scaled, "in"
    if kind.startswith("rotate2d"):
        return _turned(values.constant(node, "amount", (0.0,))[0]), "in"
    if kind.startswith("dot_"):
        return np.eye(3), "in"
    operation = kind.partition("_")[0]
    if operation in ("add", "subtract", "multiply", "divide"):
        sign = -1.0 if operation == "subtract" else 1.0
        if operation in ("add", "subtract"):
            return _moved(sign * pair("in2", 0.0)), "in1"
        factors = pair("in2", 1.0)
        if operation == "divide":
            factors = _divided(values, node, np.ones(2), factors)
        return _scaled(factors), "in1"
    raise UnfitError(node, "it is no affine transform")


def _placed(
    values: NodeValues,
    node: UsdShade.Shader,
    pivot: tuple[float, float],
    scale: Array,
    turn: float,
    offset: Array,
) -> Array:
    """MaterialX's place2d: scale, rotation and offset around a pivot, or in the other order."""
    center = np.array(values.constant(node, "pivot", pivot))
    moved = _moved(-offset)
    if values.constant(node, "operationorder", (0.0,))[0]:
        inner = _scaled(scale) @ _turned(turn) @ moved
    else:
        inner = moved @ _turned(turn) @ _scaled(scale)
    return _moved(center) @ inner @ _moved(-center)


def _divided(values: NodeValues, node: UsdShade.Shader, above: Array, below: Array) -> Array:
    if (below == 0.0).any():
        raise UnfitError(node, "it divides by 0")
    return np.asarray(above / below)


def _scaled(factors: Array) -> Array:
    return np.diag([factors[0], factors[1], 1.0])


def _moved(by: Array) -> Array:
    matrix = np.eye(3)
    matrix[:2, 2] = by
    return matrix


def _turned(degrees: float) -> Array:
    """MaterialX's rotate2d, clockwise where v points up."""
    sine, cosine = math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
    return np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
