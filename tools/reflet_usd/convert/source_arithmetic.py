"""Arithmetic of sources: texture reads take one factor and one addend for each number."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from pxr import UsdShade

from .context import FLOAT32_LIMIT
from .sources import Constant, Part, Source, TextureRead, UnfitError

Numbers = tuple[float, ...]


def mapped(node: UsdShade.Shader, function: Callable[..., float], *columns: Numbers) -> Constant:
    """A function of each row of numbers; raises UnfitError where the result is no finite number."""
    try:
        values = tuple(float(function(*row)) for row in zip(*columns, strict=True))
    except (ArithmeticError, ValueError):
        raise UnfitError(node, "its value is not a number") from None
    if not all(abs(value) < FLOAT32_LIMIT for value in values):
        raise UnfitError(node, "its value is not finite")
    return Constant(values)


def widened(source: Source, width: int) -> Source:
    """The source with `width` numbers: one number is repeated, surplus ones are left out."""
    if isinstance(source, Constant):
        return Constant(tuple(np.resize(source.value, width).tolist()))
    if isinstance(source, TextureRead):
        return replace(source, parts=(source.parts * width)[:width])
    return source


def affine(node: UsdShade.Shader, source: Source, scale: Numbers, bias: Numbers) -> Source:
    """`source` · scale + bias; raises UnfitError for primvars, which no factor multiplies."""
    if isinstance(source, Constant):
        columns = (source.value, scale, bias)
        return mapped(node, lambda value, k, b: value * k + b, *columns)
    if isinstance(source, TextureRead):
        parts = tuple(
            Part(p.channel, p.scale * k, p.bias * k + b, p.fallback * k + b)
            for p, k, b in zip(source.parts, scale, bias, strict=True)
        )
        ends = [end for p in parts for end in (p.scale, p.bias, p.fallback)]
        if not all(abs(end) < FLOAT32_LIMIT for end in ends):
            raise UnfitError(node, "its value is not finite")
        return replace(source, parts=parts)
    if set(scale) == {1.0} and set(bias) == {0.0}:
        return source
    raise UnfitError(node, "it changes the values of a primvar")


def total(node: UsdShade.Shader, first: Source, last: Source) -> Source:
    """The sum, of which at most one part is a texture or primvar; raises UnfitError."""
    if isinstance(first, Constant):
        first, last = last, first
    if not isinstance(last, Constant):
        raise UnfitError(node, "it adds two textures")
    return affine(node, first, (1.0,) * len(last.value), last.value)


def product(node: UsdShade.Shader, first: Source, last: Source) -> Source:
    """The product, of which at most one part is a texture or primvar; raises UnfitError."""
    if isinstance(first, Constant):
        first, last = last, first
    if not isinstance(last, Constant):
        raise UnfitError(node, "it multiplies two textures")
    return affine(node, first, last.value, (0.0,) * len(last.value))


def mixed(node: UsdShade.Shader, ground: Source, figure: Source, share: Source) -> Source:
    """`ground` · (1 − share) + `figure` · share; raises UnfitError."""
    if ground == figure:
        return ground
    if not isinstance(share, Constant):
        if not isinstance(ground, Constant) or not isinstance(figure, Constant):
            raise UnfitError(node, "it mixes textures by a texture")
        pairs = zip(figure.value, ground.value, strict=True)
        return affine(node, share, tuple(f - g for f, g in pairs), ground.value)
    if set(share.value) in ({0.0}, {1.0}):
        return figure if share.value[0] else ground
    rest = tuple(1.0 - number for number in share.value)
    nothing = (0.0,) * len(rest)
    return total(
        node,
        affine(node, ground, rest, nothing),
        affine(node, figure, share.value, nothing),
    )


def picked(node: UsdShade.Shader, source: Source, places: tuple[int, ...]) -> Source:
    """Some numbers of a source; raises UnfitError for primvars."""
    if isinstance(source, Constant):
        return Constant(tuple(source.value[place] for place in places))
    if isinstance(source, TextureRead):
        return replace(source, parts=tuple(source.parts[place] for place in places))
    raise UnfitError(node, "it takes a primvar apart")


def joined(node: UsdShade.Shader, sources: list[Source]) -> Source:
    """The numbers of all sources, which read one texture at most; raises UnfitError."""
    if all(isinstance(source, Constant) for source in sources):
        return Constant(tuple(n for s in sources if isinstance(s, Constant) for n in s.value))
    reads = [source for source in sources if isinstance(source, TextureRead)]
    alike = {(read.file, read.uv, read.wrap, read.color_space) for read in reads}
    if len(alike) != 1:
        raise UnfitError(node, "it joins several textures or primvars")
    parts: list[Part] = []
    for source in sources:
        if isinstance(source, TextureRead):
            parts += source.parts
        elif isinstance(source, Constant):
            channel = reads[0].parts[0].channel
            parts += [Part(channel, 0.0, number, number) for number in source.value]
        else:
            raise UnfitError(node, "it joins a texture and a primvar")
    return replace(reads[0], parts=tuple(parts[:4]))
