"""Renders scenes that are written as text, with hybrid reflections.

>>> import reflet
>>> with reflet.open("scene.toml", samples=16) as session:
...     picture = session.render(aovs=["depth"])
...     picture.save("scene.png")

Lengths are meters, angles degrees, +Y is up; arrays have their rows from the top.
"""

from reflet._reflet import (
    AOVS,
    CAUSES,
    SOURCES,
    Comparison,
    Frames,
    Picture,
    Scores,
    Session,
    __version__,
    compare,
    open,
)
from reflet.errors import (
    ArgumentError,
    ClosedError,
    DeviceError,
    Diagnostic,
    Error,
    ForkError,
    FrameError,
    NoAdapterError,
    SceneError,
    SceneWarning,
    UnknownNameError,
)

__all__ = [
    "AOVS",
    "CAUSES",
    "SOURCES",
    "ArgumentError",
    "ClosedError",
    "Comparison",
    "DeviceError",
    "Diagnostic",
    "Error",
    "ForkError",
    "FrameError",
    "Frames",
    "NoAdapterError",
    "Picture",
    "SceneError",
    "SceneWarning",
    "Scores",
    "Session",
    "UnknownNameError",
    "__version__",
    "compare",
    "open",
]
