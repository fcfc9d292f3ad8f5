"""Unity's axes: left-handed, X right, Y up, Z forward, as VMC and Rokoko send them."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

TO_WORLD = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""From Unity's axes to the project's: X forward, Y left, Z up. It mirrors."""


def positions_to_world(positions: Array) -> Array:
    """Positions (..., 3) in the project's axes, of those in Unity's."""
    return positions @ TO_WORLD.T


def positions_to_unity(positions: Array) -> Array:
    """Positions (..., 3) in Unity's axes, of those in the project's."""
    return positions @ TO_WORLD


def rotations_to_world(quaternions: Array) -> Array:
    """Rotation matrices (n, 3, 3) in the project's axes, of quaternions (n, 4), xyzw, in Unity's."""
    result: Array = TO_WORLD @ Rotation.from_quat(quaternions).as_matrix() @ TO_WORLD.T
    return result


def rotations_to_unity(rotations: Array) -> Array:
    """Quaternions (n, 4), xyzw, in Unity's axes, of rotation matrices (n, 3, 3) in the project's."""
    result: Array = Rotation.from_matrix(TO_WORLD.T @ rotations @ TO_WORLD).as_quat()
    return result
