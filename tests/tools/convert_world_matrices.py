"""Owns the comparison of a converted node's world matrix with USD's own, at any time."""

import numpy as np
import pytest
from pxr import Usd, UsdGeom
from read_converted import Converted

Y_UP = np.eye(4)
Z_UP = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], dtype=float)


def usd_world(stage: Usd.Stage, prim: str, code: float | None, meters: float) -> np.ndarray:
    """USD's own local-to-world matrix, for column vectors, in meters."""
    time = Usd.TimeCode.EarliestTime() if code is None else Usd.TimeCode(code)
    xformable = UsdGeom.Xformable(stage.GetPrimAtPath(prim))
    matrix = np.array(xformable.ComputeLocalToWorldTransform(time)).T
    matrix[:3, 3] *= meters
    return matrix


def points_of(matrix: np.ndarray) -> np.ndarray:
    cube = np.array([[x, y, z, 1] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    return (cube @ matrix.T)[:, :3]


def check_world(done: Converted, prim: str, codes: list[float | None]) -> None:
    """Assert that the world positions of the prim's cube agree with USD's at each time code."""
    stage = Usd.Stage.Open(str(done.out.with_name("stage.usda")))
    usd = done.json["scenes"][0]["extras"]["usd"]
    axis = Z_UP if usd["upAxis"] == "Z" else Y_UP
    for code in codes:
        seconds = None
        if code is not None:
            seconds = (code - usd["timeOrigin"]) / usd["timeCodesPerSecond"]
        expected = axis @ usd_world(stage, prim, code, usd["metersPerUnit"])
        found = done.world(seconds)[done.node(prim)]
        size = np.ptp(points_of(expected), axis=0).max()
        assert points_of(found) == pytest.approx(points_of(expected), abs=1e-5 * max(size, 1.0)), (
            f"{prim} at {code}"
        )
