"""The maximum depth of nodes in a written file, since readers of glTF that recurse have a limit."""

from .scene import Node
from .types import ConvertError

# Reflet reads any depth; USD and other readers follow parents by recursion.
MAX_LEVELS = 256
_SHOWN_CHARS = 120


def check_level(level: int, path: str) -> None:
    """Raise `too-deep` where the node of the prim at `path` is below the last level."""
    if level <= MAX_LEVELS:
        return
    shown = path if len(path) <= _SHOWN_CHARS else f"{path[:_SHOWN_CHARS]}…"
    message = (
        f"its node is on level {level} of the file, at most {MAX_LEVELS} are written"
        " (the helper nodes of shears, op chains and instances count); flatten the groups above"
    )
    raise ConvertError("too-deep", message, shown)


def levels_to(outer: Node, node: Node) -> int:
    """Number of levels from `outer` down to `node`, both included."""
    levels = 1
    while outer is not node:
        outer = outer.children[0]
        levels += 1
    return levels


def check_depth(roots: list[Node]) -> None:
    """Raise `too-deep` where any node below `roots` is too deep; joints and instances too."""
    stack = [(root, 1, root.prim) for root in reversed(roots)]
    while stack:
        node, level, path = stack.pop()
        check_level(level, path)
        stack.extend((child, level + 1, child.prim or path) for child in node.children)
