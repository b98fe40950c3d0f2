"""Reads MaterialX documents (`.mtlx`) as layers of USD, which usd-core's wheels cannot.

The layer has the prims that OpenUSD's own plugin gives a document: `/MaterialX/Materials/NAME`
with the surface's node and node graphs below it, so that references into a document find them.
Converter and validator share this reader, as they share usd-core; each evaluates the nodes itself.
"""

import os
import posixpath
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from pxr import Ar, Sdf, Tf

from reflet_usd.stage_files import editable, is_plain_file, is_within, outer_file

SUFFIX = ".mtlx"
MOST_BYTES = 16 << 20
"""Maximum size of one document."""
MOST_NODES = 20_000
"""Maximum number of nodes of a document's layer; materials that share a graph each have it."""
_MOST_INCLUDES = 100
_TYPES = {
    "boolean": Sdf.ValueTypeNames.Bool,
    "color3": Sdf.ValueTypeNames.Color3f,
    "color4": Sdf.ValueTypeNames.Color4f,
    "filename": Sdf.ValueTypeNames.Asset,
    "float": Sdf.ValueTypeNames.Float,
    "integer": Sdf.ValueTypeNames.Int,
    "string": Sdf.ValueTypeNames.String,
    "vector2": Sdf.ValueTypeNames.Float2,
    "vector3": Sdf.ValueTypeNames.Float3,
    "vector4": Sdf.ValueTypeNames.Float4,
}
_VECTORS = {
    kind: of.type.pythonClass for kind, of in _TYPES.items() if kind.startswith(("color", "vector"))
}
_METERS = {
    "micrometer": 1e-6,
    "millimeter": 1e-3,
    "centimeter": 1e-2,
    "inch": 0.0254,
    "foot": 0.3048,
    "yard": 0.9144,
    "kilometer": 1e3,
    "mile": 1609.344,
}
_OUTPUTS = {
    "surfaceshader": "surface",
    "displacementshader": "displacement",
    "volumeshader": "volume",
}


class DocumentError(Exception):
    """A document that is not read; `name` is the warning's."""

    def __init__(self, name: str, message: str) -> None:
        super().__init__(message)
        self.name = name


@dataclass
class Document:
    """A document as a layer."""

    layer: Sdf.Layer
    files: list[str] = field(default_factory=list)
    """Paths of the document and its included documents."""
    images: list[str] = field(default_factory=list)
    """Absolute paths of the images that it names, in the document's package where it is in one."""


def is_document(path: str) -> bool:
    """Whether an asset path names a MaterialX document, perhaps in a package: `a.usdz[b.mtlx]`."""
    return path.rstrip("]").lower().endswith(SUFFIX)


def read_document(path: str, roots: tuple[str, ...]) -> Document:
    """The document at `path` with its included documents; raises DocumentError.

    Files are opened below `roots` alone: the folder of the stage and folders that the user names.
    Documents in these named folders define nodes, as OpenUSD's PXR_MTLX_PLUGIN_SEARCH_PATHS does.
    """
    try:
        import MaterialX as mx  # noqa: N813
    except ImportError:
        message = "the Python package MaterialX is not installed; run tools/setup.sh, or"
        raise DocumentError("materialx-missing", f"{message} `pip install MaterialX`") from None
    files: list[str] = []
    including: list[str] = []

    def read(document: Any, path: str, options: Any) -> None:
        """Read one file, and its included files."""
        files.append(path)
        including.append(path)
        try:
            mx.readFromXmlString(document, _content(path), mx.FileSearchPath(), options)
        finally:
            including.pop()

    def include(document: Any, name: Any, _search: Any, options: Any) -> None:
        """Read a file that the one being read includes; MaterialX calls this."""
        text = name.asString() if hasattr(name, "asString") else str(name)
        found = _beside(including[-1], text)
        if not is_within(found, roots):
            raise DocumentError("asset-outside-roots", f"it includes @{text}@ from elsewhere")
        if found in including or len(files) > _MOST_INCLUDES:
            raise DocumentError("materialx-unreadable", f"it includes @{text}@ again and again")
        if found not in files:
            read(document, found, options)

    document = mx.createDocument()
    options = mx.XmlReadOptions()
    options.readXIncludeFunction = include
    try:
        read(document, path, options)
        for plugin in (found for root in roots[1:] for found in _definitions(root, roots)):
            if plugin not in files:
                _define(mx, document, plugin, read, options)
        _leave_namespaces(mx, document)
        own = {found.getName() for found in document.getNodeDefs()}
        document.setDataLibrary(_library(mx))
        _unfold(document, own)
        writer = _Writer(mx, path)
        layer = writer.write(document)
    except DocumentError:
        raise
    except _failures(mx) as error:
        reason = " ".join(str(error).split())[:300] or type(error).__name__
        raise DocumentError("materialx-unreadable", reason) from None
    return Document(layer, files, writer.images)


def refer(layer: Sdf.Layer, asset_path: str, stand_in: str) -> None:
    """Have sublayers, references and payloads name another layer, or none if it is "".

    In packages too, whose asset paths UsdUtils does not change. The layer is changed in memory.
    """
    with editable(layer):
        # A layer that is both sublayer and reference takes two calls.
        while asset_path in layer.GetCompositionAssetDependencies():
            if not layer.UpdateCompositionAssetDependency(asset_path, stand_in):
                break


def _content(path: str) -> str:
    is_file = os.path.isfile(outer_file(path))
    asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path)) if is_file else None
    if not asset:
        name = os.path.basename(path.rstrip("]"))
        raise DocumentError("materialx-unreadable", f"{name} is no plain file, or not there")
    if asset.GetSize() > MOST_BYTES:
        raise DocumentError("materialx-too-large", f"it has more than {MOST_BYTES} bytes")
    return bytes(asset.GetBuffer() or b"").decode("utf-8", "replace")


def _beside(path: str, name: str) -> str:
    """Path of a file that the file at `path` names, in the same package if it is in a package."""
    package, inner = Ar.SplitPackageRelativePathInner(path)
    if not inner:
        return os.path.normpath(os.path.join(os.path.dirname(path), name))
    inside = posixpath.normpath(posixpath.join(posixpath.dirname(inner), name))
    return str(Ar.JoinPackageRelativePath(package, inside))


def _library(mx: Any) -> Any:
    """Definitions of MaterialX's standard nodes."""
    library = mx.createDocument()
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath(), library)
    return library


def _failures(mx: Any) -> tuple[type[Exception], ...]:
    """Errors of documents that are broken or hostile."""
    return (
        mx.Exception,
        mx.ExceptionParseError,
        mx.ExceptionFileMissing,
        mx.ExceptionFoundCycle,
        LookupError,
        OSError,
        RuntimeError,
        Tf.ErrorException,
        ValueError,
    )


def _definitions(folder: str, roots: tuple[str, ...]) -> list[str]:
    """Paths of the documents in a folder that define nodes; others in it are not the user's."""
    found = []
    for name in sorted(os.listdir(folder)) if os.access(folder, os.R_OK) else ():
        path = os.path.join(folder, name)
        if is_document(name) and is_plain_file(path) and is_within(path, roots):
            try:
                defines = "<nodedef" in _content(path)
            except DocumentError:
                continue
            found += [path] if defines else []
    return found[:_MOST_INCLUDES]


def _define(mx: Any, document: Any, path: str, read: Callable[..., None], options: Any) -> None:
    """Add the nodes that a document defines, but for names that are there already.

    One that cannot be read defines none; nodes that a material then lacks are named there.
    """
    definitions = mx.createDocument()
    try:
        read(definitions, path, options)
    except DocumentError:
        return
    except _failures(mx):
        return
    for other in definitions.getChildren():
        if not any(other.isA(kind) for kind in (mx.NodeDef, mx.NodeGraph)):
            definitions.removeChild(other.getName())
    document.importLibrary(definitions)


def _leave_namespaces(mx: Any, document: Any) -> None:
    """Join namespaces with the names in them, but for nodes that the document does not define.

    MaterialX loses the connections of nodes in a namespace when it replaces them.
    """
    defined = {(found.getNamespace(), found.getNodeString()) for found in document.getNodeDefs()}
    elements = [found for found in document.traverseTree() if found.getParent() is not None]
    spaces = [found.getNamespace() or found.getParent().getNamespace() for found in elements]
    for element, space in zip(elements, spaces, strict=True):
        if space and element.isA(mx.Node) and (space, element.getCategory()) in defined:
            element.setCategory(f"{space}_{element.getCategory()}")
        for name in ("node", "nodedef") if space and not element.isA(mx.Node) else ():
            if element.hasAttribute(name):
                element.setAttribute(name, f"{space}_{element.getAttribute(name)}")
        if element.hasNamespace():
            if not element.isA(mx.Node):
                element.setName(f"{space}_{element.getName().rpartition(':')[2]}")
            element.removeAttribute("namespace")


def _unfold(document: Any, own: set[str]) -> None:
    """Replace nodes that the document itself defines by the graphs that they stand for."""

    def is_own(node: Any) -> bool:
        definition = node.getNodeDef()
        return definition is not None and definition.getName() in own

    for graph in (document, *document.getNodeGraphs()) if own else ():
        for node in filter(is_own, graph.getNodes()):
            _keep_color_spaces(node)
        graph.flattenSubgraphs("", is_own)


def _keep_color_spaces(node: Any) -> None:
    """State the color spaces of images that a node's graph reads at the node's own inputs."""
    graph = node.getNodeDef().getImplementation()
    for inner in graph.traverseTree() if graph is not None else ():
        named = inner.getAttribute("interfacename")
        outer = node.getInput(named) if named and inner.hasColorSpace() else None
        if outer is not None and not outer.hasColorSpace():
            outer.setColorSpace(inner.getColorSpace())


class _Writer:
    """Writes the materials of a document as prims."""

    def __init__(self, mx: Any, path: str) -> None:
        self.mx = mx
        self.path = path
        self.layer = Sdf.Layer.CreateAnonymous("document.usda")
        self.images: list[str] = []
        self._nodes = 0

    def write(self, document: Any) -> Sdf.Layer:
        """The layer of a document."""
        with Sdf.ChangeBlock():
            root = self._prim(self.layer.pseudoRoot, "MaterialX", "Scope")
            self.layer.defaultPrim = "MaterialX"
            materials = self._prim(root, "Materials", "Scope")
            for node in document.getMaterialNodes():
                self._material(materials, node)
        return self.layer

    def _material(self, parent: Sdf.PrimSpec, node: Any) -> None:
        material = self._prim(parent, node.getName(), "Material")
        wanted: list[Any] = []
        for source in node.getInputs():
            kind, shader = source.getType(), source.getConnectedNode()
            if kind in _OUTPUTS and shader is not None:
                output = self._output(material, f"outputs:mtlx:{_OUTPUTS[kind]}")
                output.connectionPathList.explicitItems = [self._place(material, shader, "")]
                wanted.append(shader)
        written: set[str] = set()
        while wanted:  # no recursion: graphs may be of any depth, and have cycles
            shader = wanted.pop()
            if shader.getNamePath() not in written:
                written.add(shader.getNamePath())
                wanted += self._shader(material, shader)

    def _shader(self, material: Sdf.PrimSpec, node: Any) -> Iterator[Any]:
        """Write one node; yields the nodes that it is connected to."""
        self._nodes += 1
        if self._nodes > MOST_NODES:
            message = f"its materials have more than {MOST_NODES} nodes"
            raise DocumentError("materialx-too-large", message)
        path = self._place(material, node, "").GetPrimPath()
        parent = material
        if path.GetParentPath() != material.path:
            name = path.GetParentPath().name
            parent = self._prim(material, name, "NodeGraph")
        prim = self._prim(parent, path.name, "Shader")
        definition = node.getNodeDef()
        identifier = Sdf.AttributeSpec(
            prim, "info:id", Sdf.ValueTypeNames.Token, Sdf.VariabilityUniform
        )
        identifier.default = definition.getName() if definition else node.getCategory()
        outputs = [end.getName() for end in definition.getActiveOutputs()] if definition else []
        for name in outputs or ["out"]:
            self._output(prim, f"outputs:{_name(name)}")
        found = []
        for source in node.getInputs():
            other = self._input(material, prim, source)
            if other is not None:
                found.append(other)
        return iter(found)

    def _input(self, material: Sdf.PrimSpec, prim: Sdf.PrimSpec, source: Any) -> Any:
        """Write one input; returns the node that it is connected to, if any."""
        kind = _TYPES.get(source.getType(), Sdf.ValueTypeNames.Token)
        attribute = Sdf.AttributeSpec(prim, f"inputs:{_name(source.getName())}", kind)
        outer = source.getInterfaceInput() if source.getInterfaceName() else None
        source = outer or source
        node = source.getConnectedNode()
        if node is not None:
            end = source.getConnectedOutput()
            output = end.getOutputString() if end is not None else source.getOutputString()
            attribute.connectionPathList.explicitItems = [self._place(material, node, output)]
            return node
        value, space = self._value(source)
        if value is not None:
            attribute.default = value
        if space:
            attribute.colorSpace = space
        return None

    def _place(self, material: Sdf.PrimSpec, node: Any, output: str) -> Sdf.Path:
        """Path of a node's output, in a node graph's prim where the node is in a graph."""
        graph = node.getParent()
        path = material.path
        if graph.isA(self.mx.NodeGraph):
            path = path.AppendChild(_name(graph.getName()))
        path = path.AppendChild(_name(node.getName()))
        return path.AppendProperty(f"outputs:{_name(output or 'out')}")

    def _value(self, source: Any) -> tuple[Any, str]:
        """An input's value and the color space of images; colors become linear."""
        kind, text = source.getType(), source.getResolvedValueString()
        space = source.getActiveColorSpace()
        if kind == "filename":
            return self._asset(source, text), space
        if kind == "string":
            return text, ""
        if kind == "boolean":
            return text.strip() == "true", ""
        if kind not in ("float", "integer", *_VECTORS) or not text.strip():
            return None, ""
        values = _numbers(text)
        if kind == "integer":
            return (int(values[0]) if values and abs(values[0]) < 2**31 else None), ""
        meters = _METERS.get(source.getUnit(), 1.0)
        values = [value * meters for value in values]
        if kind == "float":
            return (values[0] if values else None), ""
        if kind.startswith("color") and space.lower() == "srgb_texture":
            values[:3] = [_linear(value) for value in values[:3]]
        make = _VECTORS[kind]
        return (make(*values) if len(values) == make.dimension else None), ""

    def _asset(self, source: Any, text: str) -> Sdf.AssetPath | None:
        """Absolute path of a file, by the document's prefix; some exporters state that twice."""
        choices = [text, source.getValueString()]
        if not text or any("\0" in choice for choice in choices):
            return None
        paths = [_beside(self.path, choice.replace("\\", "/")) for choice in choices]
        resolve = Ar.GetResolver().Resolve
        chosen = next((path for path in paths if resolve(path)), paths[0])
        self.images.append(chosen)
        return Sdf.AssetPath(chosen)

    def _output(self, prim: Sdf.PrimSpec, name: str) -> Sdf.AttributeSpec:
        return Sdf.AttributeSpec(prim, name, Sdf.ValueTypeNames.Token)

    def _prim(self, parent: Sdf.PrimSpec, name: str, kind: str) -> Sdf.PrimSpec:
        """The child of that name, made where it is not there."""
        name = _name(name)
        known = self.layer.GetPrimAtPath(parent.path.AppendChild(name))
        return known or Sdf.PrimSpec(parent, name, Sdf.SpecifierDef, kind)


def _name(text: str) -> str:
    """An element's name as USD's: namespaces' colons are no part of identifiers there."""
    return Tf.MakeValidIdentifier(text)


def _numbers(text: str) -> list[float]:
    """The numbers of a value; none where one is no number of single precision."""
    try:
        values = [float(part) for part in re.split(r"[\s,]+", text.strip()) if part]
    except ValueError:
        return []
    return values if all(abs(value) < 3e38 for value in values) else []


def _linear(value: float) -> float:
    """The value of an sRGB-encoded number (IEC 61966-2-1)."""
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4
