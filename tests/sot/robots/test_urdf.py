"""A URDF with what such files have: meshes, turned frames, fixed joints, fingers, joints that coincide."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from sim.convert import state_to_mujoco
from sot.errors import InputError
from sot.robots.urdf import Urdf

CORNERS = np.array([(x, y, z) for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
FACES = "3 0 1 3\n3 0 3 2\n3 4 6 7\n3 4 7 5\n3 0 4 5\n3 0 5 1\n3 2 3 7\n3 2 7 6\n3 0 2 6\n3 0 6 4\n3 1 5 7\n3 1 7 3\n"
MESH = "OFF\n8 12 0\n" + "".join(f"{x} {y} {z}\n" for x, y, z in CORNERS) + FACES


def link(name: str, more: str = "") -> str:
    return f"""<link name="{name}"><inertial><origin xyz="0.01 -0.02 0.1" rpy="0.3 0.2 0.1"/><mass value="1.5"/>
        <inertia ixx="0.02" iyy="0.03" izz="0.025" ixy="0.001" ixz="-0.002" iyz="0.003"/></inertial>{more}</link>"""


def joint(name: str, parent: str, child: str, xyz: str, axis: str = "0 1 0", kind: str = "revolute") -> str:
    return f"""<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>
        <origin xyz="{xyz}" rpy="0.1 -0.4 0.7"/><axis xyz="{axis}"/><dynamics damping="0.3" friction="0.2"/>
        <limit lower="-1" upper="1.5" effort="40" velocity="3"/></joint>"""


def shape(kind: str, geometry: str) -> str:
    return f'<{kind}><origin xyz="0 0 0.1" rpy="0 0.2 0"/><geometry>{geometry}</geometry></{kind}>'


LONG = '<mesh filename="package://toy/meshes/cube.off" scale="0.1 0.08 0.4"/>'
FLAT = '<mesh filename="package://toy/meshes/cube.off" scale="0.1 0.3 0.4"/>'
TOY = "".join(
    (
        '<robot name="toy"><link name="base"/>',
        link("trunk", shape("collision", FLAT) + shape("visual", FLAT)),
        joint("fix", "base", "trunk", "0 0 0.1", kind="fixed"),
        link("housing", shape("collision", LONG)),
        joint("shoulder", "trunk", "housing", "0 0.3 0.2", "1 2 2"),
        link("arm", shape("collision", LONG) + shape("visual", LONG)),
        joint("roll", "housing", "arm", "0 0 0", "1 0 0"),
        link("hand", shape("collision", '<sphere radius="0.05"/>')),
        joint("wrist", "arm", "hand", "0 0 0.5"),
        link("finger", shape("collision", '<cylinder radius="0.01" length="0.1"/>')),
        joint("knuckle", "hand", "finger", "0 0 0.1"),
        "</robot>",
    )
)


@pytest.fixture(scope="module")
def toy(tmp_path_factory):
    folder = tmp_path_factory.mktemp("package") / "toy"
    for sub in ("urdf", "meshes"):
        (folder / sub).mkdir(parents=True)
    (folder / "meshes/cube.off").write_text(MESH)
    (folder / "urdf/toy.urdf").write_text(TOY)
    return folder / "urdf/toy.urdf"


@pytest.fixture(scope="module")
def urdf(toy):
    return Urdf.read(toy, {"knuckle": 0.4})


@pytest.fixture(scope="module")
def model(urdf):
    return mujoco.MjModel.from_xml_string(urdf.mjcf("toy", pin.neutral(urdf.model)))


def test_a_locked_joint_becomes_part_of_its_body(toy, urdf):
    assert list(urdf.model.names)[2:] == ["shoulder", "roll", "wrist"]
    free = Urdf.read(toy, {}).model
    assert pin.computeTotalMass(urdf.model) == pytest.approx(pin.computeTotalMass(free))
    q, q_free = pin.neutral(urdf.model), pin.neutral(free)
    q_free[-1] = 0.4
    com = [pin.centerOfMass(m, m.createData(), at) for m, at in ((urdf.model, q), (free, q_free))]
    np.testing.assert_allclose(*com, atol=1e-12)


def test_both_libraries_mean_the_same_robot(urdf, model):
    """Mass matrix, bias forces, centre of mass and Jacobian of the hand, in the conventions of MuJoCo."""
    rng = np.random.default_rng(0)
    data, mj = urdf.model.createData(), mujoco.MjData(model)
    M_mj, J_mj = np.zeros((model.nv, model.nv)), np.zeros((3, model.nv))
    for _ in range(50):
        q = pin.randomConfiguration(urdf.model, np.full(urdf.model.nq, -1.0), np.full(urdf.model.nq, 1.0))
        v = rng.normal(size=urdf.model.nv)
        mj.qpos[:], mj.qvel[:] = state_to_mujoco(q, v)
        mujoco.mj_forward(model, mj)
        T = np.eye(model.nv)
        T[:3, :3] = R = pin.Quaternion(q[3:7]).matrix()
        mujoco.mj_fullM(model, mj, M_mj)
        M = pin.crba(urdf.model, data, q)
        np.testing.assert_allclose(T.T @ M_mj @ T, np.triu(M) + np.triu(M, 1).T, atol=1e-9)
        turned = np.concatenate([R @ np.cross(v[3:6], v[:3]), np.zeros(model.nv - 3)])
        h = pin.nonLinearEffects(urdf.model, data, q, v)
        np.testing.assert_allclose(T.T @ (mj.qfrc_bias + M_mj @ turned), h, atol=1e-9)
        np.testing.assert_allclose(mj.subtree_com[1], pin.centerOfMass(urdf.model, data, q), atol=1e-9)
        wrist = urdf.model.getJointId("wrist")
        pin.computeJointJacobians(urdf.model, data, q)
        J = pin.getJointJacobian(urdf.model, data, wrist, pin.LOCAL_WORLD_ALIGNED)[:3]
        mujoco.mj_jacBody(model, mj, J_mj, None, model.body("hand").id)
        np.testing.assert_allclose(J_mj @ T, J, atol=1e-9)
    np.testing.assert_array_equal(model.dof_damping[6:], 0.3)
    np.testing.assert_array_equal(model.dof_frictionloss[6:], 0.2)
    np.testing.assert_array_equal(model.jnt_range[1:], [[-1.0, 1.5]] * 3)


def test_meshes_become_primitives_about_them(model):
    """A long one a capsule, a flat one a box, both as large as the mesh at its scale; a housing none at all."""
    shapes = [g for g in range(model.ngeom) if model.geom_group[g] == 3]
    assert {model.body(body).name for body in model.geom_bodyid[shapes]} == {"base", "arm", "hand"}
    trunk, arm = model.geom("root_joint_meshes").id, model.geom("roll_meshes").id
    assert model.geom_type[trunk] == mujoco.mjtGeom.mjGEOM_BOX
    assert model.geom_type[arm] == mujoco.mjtGeom.mjGEOM_CAPSULE
    np.testing.assert_allclose(2 * model.geom_size[trunk], [0.1, 0.3, 0.4], atol=1e-6)
    radius, half = model.geom_size[arm, :2]
    assert radius == pytest.approx(0.045, abs=1e-6) and radius + half == pytest.approx(0.2, abs=1e-6)
    centre = pin.SE3(pin.rpy.rpyToMatrix(0.0, 0.2, 0.0), np.array([0.0, 0.0, 0.1])).act(np.array([0.05, 0.04, 0.2]))
    np.testing.assert_allclose(model.geom_pos[arm], centre, atol=1e-6)


def test_neighbours_do_not_collide_and_others_do(urdf, model):
    """The hand's way to the trunk has a length between; the arm's, around its housing, has none."""
    excluded = {(int(pair) >> 16, int(pair) & 0xFFFF) for pair in model.exclude_signature}
    names = {tuple(sorted(model.body(body).name for body in pair)) for pair in excluded}
    assert ("arm", "base") in names and ("arm", "hand") in names
    assert ("base", "hand") not in names


def test_a_foot_collides_with_its_sole(urdf):
    wrist = urdf.model.getJointId("wrist")
    sole = np.array([[0.1, 0.05, -0.2], [0.1, -0.05, -0.2], [-0.05, -0.05, -0.2], [-0.05, 0.05, -0.2]])
    text = urdf.with_soles({wrist: sole}).mjcf("toy", pin.neutral(urdf.model))
    model = mujoco.MjModel.from_xml_string(text)
    (hand,) = (g for g in range(model.ngeom) if model.geom_bodyid[g] == model.body("hand").id)
    low, high = model.geom_pos[hand] - model.geom_size[hand], model.geom_pos[hand] + model.geom_size[hand]
    np.testing.assert_allclose(low, [-0.05, -0.05, -0.2])
    np.testing.assert_allclose(high[:2], [0.1, 0.05])


def test_what_cannot_be_read_is_refused_in_one_line(toy, tmp_path):
    with pytest.raises(InputError, match="no joint 'thumb' to lock"):
        Urdf.read(toy, {"thumb": 0.0})
    alone = tmp_path / "toy.urdf"
    alone.write_text(TOY)
    with pytest.raises(InputError, match=r"toy.urdf: Pinocchio cannot read it: .*cube.off"):
        Urdf.read(alone, {})
