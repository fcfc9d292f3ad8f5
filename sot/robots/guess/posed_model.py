"""The links and joints of a MuJoCo model in a posture, and where its geometry is: what guesses are made from."""

from collections.abc import Callable, Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROUND_SAMPLES = 24  # directions in which a round shape is sampled
VISUAL_GROUP = 2  # highest group in which models keep what is only seen, by convention


class PosedModel:
    """A model whose bodies without joints are counted as part of the link that carries them.

    Everything is in the world, at the configuration that `place` was given last; at first that of the model.

    Args:
        model: MuJoCo's, with one free base.

    Attributes:
        links: numbers of the bodies that move by themselves, the base first.
        base: number of the base.
    """

    def __init__(self, model: mujoco.MjModel) -> None:
        self.model, self.data = model, mujoco.MjData(model)
        weld = model.body_weldid
        self.links = [b for b in range(1, model.nbody) if weld[b] == b]
        self.base = next(b for b in self.links if self._is_free(b))
        self._parent = {b: int(weld[model.body_parentid[b]]) for b in self.links}
        self._geoms: dict[int, list[int]] = {b: [] for b in self.links}
        for g in range(model.ngeom):
            link = int(weld[model.geom_bodyid[g]])
            if link in self._geoms and model.geom_type[g] != mujoco.mjtGeom.mjGEOM_PLANE:
                self._geoms[link].append(g)
        self.place(model.qpos0)

    def _is_free(self, body: int) -> bool:
        first = self.model.body_jntadr[body]
        return first >= 0 and self.model.jnt_type[first] == mujoco.mjtJoint.mjJNT_FREE

    def place(self, qpos: Array) -> None:
        """Put the robot into a configuration (nq,)."""
        self.data.qpos[:] = qpos
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)

    @property
    def joints(self) -> list[int]:
        """Numbers of all joints but the free one."""
        return [j for j in range(self.model.njnt) if self.model.jnt_type[j] != mujoco.mjtJoint.mjJNT_FREE]

    def name(self, link: int) -> str:
        """Of a link; one that the model does not name is numbered."""
        return str(self.model.body(link).name) or f"body_{link}"

    def joint_name(self, joint: int) -> str:
        """Of a joint; one that the model does not name is called after its link."""
        return str(self.model.joint(joint).name) or f"{self.name(self.link_of(joint))}_joint"

    def parent(self, link: int) -> int:
        """The link that carries another; the world (0) carries the base."""
        return self._parent[link]

    def children(self, link: int) -> list[int]:
        return [b for b in self.links if self._parent[b] == link]

    def joints_of(self, link: int) -> list[int]:
        """Joints by which a link moves against its parent."""
        first, count = int(self.model.body_jntadr[link]), int(self.model.body_jntnum[link])
        joints = range(first, first + count)
        return [j for j in joints if self.model.jnt_type[j] != mujoco.mjtJoint.mjJNT_FREE]

    def link_of(self, joint: int) -> int:
        """The link that a joint moves."""
        return int(self.model.jnt_bodyid[joint])

    def ancestry(self, link: int) -> list[int]:
        """A link and all that carry it, up to the base."""
        out = [link]
        while out[-1] != self.base:
            out.append(self._parent[out[-1]])
        return out

    def common_ancestor(self, first: int, second: int) -> int:
        others = set(self.ancestry(second))
        return next(link for link in self.ancestry(first) if link in others)

    def way(self, start: int, end: int) -> list[int]:
        """Links from one to another through the tree, both included."""
        top = self.common_ancestor(start, end)
        up, down = self.ancestry(start), self.ancestry(end)
        return up[: up.index(top) + 1] + down[: down.index(top)][::-1]

    def joints_between(self, start: int, end: int) -> list[int]:
        """Joints on the way from a link to another, in its order."""
        top, out = self.common_ancestor(start, end), list[int]()
        for link in self.way(start, end):
            if link != top:
                joints = self.joints_of(link)
                out += joints if link not in self.ancestry(start) else joints[::-1]
        return out

    def subtree(self, link: int) -> list[int]:
        """A link and all that it carries."""
        return [b for b in self.links if link in self.ancestry(b)]

    def moves_about_one_axis(self, joint: int) -> bool:
        return bool(self.model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE)

    def axis(self, joint: int) -> tuple[Array, Array]:
        """A point (3,) of a joint's axis and its direction (3,)."""
        return self.data.xanchor[joint].copy(), self.data.xaxis[joint].copy()

    def range(self, joint: int) -> tuple[float, float]:
        """Range of a joint [rad], infinite if it has none."""
        if not self.model.jnt_limited[joint]:
            return -np.inf, np.inf
        low, high = self.model.jnt_range[joint]
        return float(low), float(high)

    def touching(self, links: Sequence[int]) -> list[int]:
        """Geoms of links that can touch something; those that are seen where there are none."""
        geoms = [g for link in links for g in self._geoms[link]]
        model = self.model
        paired = {int(g) for g in np.concatenate([model.pair_geom1, model.pair_geom2])}
        solid = [g for g in geoms if model.geom_contype[g] or model.geom_conaffinity[g] or g in paired]
        return solid or [g for g in geoms if model.geom_group[g] > VISUAL_GROUP] or geoms

    def seen(self, links: Sequence[int]) -> list[int]:
        """Geoms of links that are looked at; those that can touch where there are none."""
        geoms = [g for link in links for g in self._geoms[link]]
        model = self.model
        return [g for g in geoms if not model.geom_contype[g] and not model.geom_conaffinity[g]] or geoms

    def surface(self, geoms: Sequence[int]) -> Array:
        """Points (n, 3) on the surfaces of geoms: corners, and samples of what is round, its lowest points included."""
        return np.vstack([np.zeros((0, 3)), *(self._surface(g, _directions_around) for g in geoms)])

    def underside(self, geoms: Sequence[int]) -> Array:
        """Points (n, 3) of geoms that a floor may touch: of what is round the lowest one only."""
        return np.vstack([np.zeros((0, 3)), *(self._surface(g, _direction_down) for g in geoms)])

    def distance(self, first: Sequence[int], second: Sequence[int], most: float) -> float:
        """Least distance of what can touch of some links and of others [m], negative where they overlap; `most` if they
        are no nearer."""
        ends, apart, reach = np.zeros(6), most, self.model.geom_rbound
        others = self.touching(second)
        for a in self.touching(first):
            for b in others:
                centres = float(np.linalg.norm(self.data.geom_xpos[a] - self.data.geom_xpos[b]))
                if centres - reach[a] - reach[b] < apart:
                    found = mujoco.mj_geomDistance(self.model, self.data, a, b, most, ends)
                    apart = min(apart, float(found))
        return apart

    def _surface(self, geom: int, directions: Callable[[Array], Array]) -> Array:
        place, turn = self.data.geom_xpos[geom], self.data.geom_xmat[geom].reshape(3, 3)
        size, kinds = self.model.geom_size[geom], mujoco.mjtGeom
        match self.model.geom_type[geom]:
            case kinds.mjGEOM_MESH:
                local = self._vertices(int(self.model.geom_dataid[geom]))
            case kinds.mjGEOM_BOX:
                local = size * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
            case kinds.mjGEOM_SPHERE:
                local = size[0] * directions(turn)
            case kinds.mjGEOM_ELLIPSOID:
                ways = directions(turn) * size  # support points: S² n / |S n|
                local = ways * size / np.linalg.norm(ways, axis=1, keepdims=True)
            case kinds.mjGEOM_CAPSULE:
                ends = np.array([[0.0, 0.0, size[1]], [0.0, 0.0, -size[1]]])
                local = np.vstack([end + size[0] * directions(turn) for end in ends])
            case kinds.mjGEOM_CYLINDER:
                rim = _rim(turn) * size[0]
                along = np.array([0.0, 0.0, size[1]])
                local = np.vstack([rim + along, rim - along])
            case _:
                local = np.zeros((0, 3))
        return place + local @ turn.T

    def _vertices(self, mesh: int) -> Array:
        model = self.model
        first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
        graph = int(model.mesh_graphadr[mesh])
        vertices = np.asarray(model.mesh_vert[first : first + count], dtype=float)
        if graph < 0:
            return vertices
        hull = int(model.mesh_graph[graph])  # vertices of the hull that MuJoCo collides with, by number
        numbers = model.mesh_graph[graph + 2 + hull : graph + 2 + 2 * hull]
        return vertices[numbers]

    def mass(self, link: int) -> float:
        """Of a link and all that it carries [kg]."""
        return float(self.model.body_subtreemass[link])


def _directions_around(turn: Array) -> Array:
    """Directions (n, 3) all round, in a frame whose place in the world is known: straight down is one of them."""
    k = np.arange(ROUND_SAMPLES) + 0.5
    z = 1.0 - 2.0 * k / ROUND_SAMPLES
    across, angle = np.sqrt(1.0 - z * z), k * np.pi * (3.0 - np.sqrt(5.0))
    ways = np.column_stack([across * np.cos(angle), across * np.sin(angle), z])
    return np.vstack([ways, np.vstack([np.eye(3), -np.eye(3)]) @ turn])


def _direction_down(turn: Array) -> Array:
    """Straight down (1, 3), in the same way."""
    return -turn[2:]


def _rim(turn: Array) -> Array:
    """Directions (n, 3) about a cylinder's axis, the lowest and the highest included."""
    up = turn.T @ (0.0, 0.0, 1.0)
    first = np.arctan2(up[1], up[0])
    angle = first + 2.0 * np.pi * np.arange(ROUND_SAMPLES) / ROUND_SAMPLES
    return np.column_stack([np.cos(angle), np.sin(angle), np.zeros(ROUND_SAMPLES)])
