"""A URDF with what such files have: meshes, turned frames, fixed joints, fingers, joints that coincide."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from sim.convert import state_to_mujoco
from sot.errors import InputError
from sot.robots.reading import read_model
from sot.robots.reading.solid import COLLISION_GROUP

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
    return read_model(toy, {"knuckle": 0.4})


@pytest.fixture(scope="module")
def model(urdf):
    return urdf.compiled


def test_a_locked_joint_becomes_part_of_its_body(toy, urdf):
    assert list(urdf.model.names)[2:] == ["shoulder", "roll", "wrist"]
    free = read_model(toy).model
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
    """Boxes as large as the meshes at their scales; a housing none at all."""
    shapes = [g for g in range(model.ngeom) if model.geom_group[g] == COLLISION_GROUP]
    assert {model.body(body).name for body in model.geom_bodyid[shapes]} == {"base", "arm", "hand"}
    trunk, arm = model.geom("base_meshes").id, model.geom("arm_meshes").id
    assert model.geom_type[trunk] == mujoco.mjtGeom.mjGEOM_BOX
    assert model.geom_type[arm] == mujoco.mjtGeom.mjGEOM_BOX
    np.testing.assert_allclose(2 * model.geom_size[trunk], [0.1, 0.3, 0.4], atol=1e-6)
    np.testing.assert_allclose(2 * model.geom_size[arm], [0.1, 0.08, 0.4], atol=1e-6)
    centre = pin.SE3(pin.rpy.rpyToMatrix(0.0, 0.2, 0.0), np.array([0.0, 0.0, 0.1])).act(np.array([0.05, 0.04, 0.2]))
    np.testing.assert_allclose(model.geom_pos[arm], centre, atol=1e-6)


def test_what_cannot_be_read_is_refused_in_one_line(toy, tmp_path):
    with pytest.raises(InputError, match="no joint 'thumb' to lock"):
        read_model(toy, {"thumb": 0.0})
    alone = tmp_path / "toy.urdf"
    alone.write_text(TOY)
    with pytest.raises(InputError, match=r"toy.urdf: Pinocchio cannot read it: .*cube.off"):
        read_model(alone)


def test_the_parsers_own_words_are_in_the_one_line(toy, tmp_path, capfd):
    path = tmp_path / "toy.urdf"
    path.write_text(TOY.replace('<child link="finger"/>', '<child link="thumb"/>'))
    with pytest.raises(InputError, match=r"toy.urdf: .*child link \[thumb\] of joint \[knuckle\] not found"):
        read_model(path)
    path.write_text(TOY[:100])
    with pytest.raises(InputError, match=r"toy.urdf: .*line 1, column"):
        read_model(path)
    path.write_text(TOY.replace('ixx="0.02"', "").replace("package://toy", str(toy.parent.parent)))
    with pytest.raises(InputError, match=r"toy.urdf: Inertial: .*ixx"):
        read_model(path)
    assert capfd.readouterr() == ("", "")


def test_a_follower_is_held_where_its_leader_at_rest_has_it(toy, tmp_path):
    """And a joint that goes round is one without a range."""
    mimic = '<mimic joint="wrist" multiplier="-2" offset="0.3"/></joint></robot>'
    text = TOY.replace("</joint></robot>", mimic).replace("package://toy/meshes", str(toy.parent.parent / "meshes"))
    path = tmp_path / "toy.urdf"
    path.write_text(text.replace('<joint name="wrist" type="revolute">', '<joint name="wrist" type="continuous">'))
    reading = read_model(path, {"wrist": 0.1})
    assert "they are held where their leaders at rest have them: knuckle" in reading.remarks[0]
    expected = read_model(path, {"wrist": 0.1, "knuckle": 0.1})
    np.testing.assert_allclose(reading.compiled.body_inertia, expected.compiled.body_inertia, atol=1e-12)
    (wrist,) = (hinge for hinge in read_model(path).tree.hinges if hinge.name == "wrist")
    assert (wrist.lower, wrist.upper) == (-np.inf, np.inf)


def test_a_link_that_moves_without_mass_is_named(toy, tmp_path):
    path = tmp_path / "toy.urdf"
    ghost = '<link name="finger"/>' + joint("knuckle", "hand", "finger", "0 0 0.1")
    path.write_text(
        TOY[: TOY.index('<link name="finger"')].replace("package://toy", str(toy.parent.parent)) + ghost + "</robot>"
    )
    with pytest.raises(InputError, match=r"link 'finger' moves and has no mass.*\[locked\]"):
        read_model(path)


OFF_DIAGONAL = ' ixy="0" ixz="0" iyz="0"'


@pytest.mark.parametrize(
    ("moments", "remark"),
    [
        ('ixx="0" iyy="0" izz="0"', "links without inertia about some axis have that of a ball of their mass: hand"),
        ('ixx="0.001" iyy="0.001" izz="0.01"', "inertias that no body can have (A + B < C) are mended, of links hand"),
    ],
)
def test_an_inertia_that_no_body_has_is_mended_with_a_remark(toy, tmp_path, moments, remark):
    path = tmp_path / "toy.urdf"
    hand = TOY.index('<link name="hand">')
    odd = TOY[hand:].replace(
        'ixx="0.02" iyy="0.03" izz="0.025" ixy="0.001" ixz="-0.002" iyz="0.003"', moments + OFF_DIAGONAL, 1
    )
    path.write_text((TOY[:hand] + odd).replace("package://toy", str(toy.parent.parent)))
    assert read_model(path).remarks == (remark,)


def test_a_sliding_joint_is_named_with_its_remedy(toy, tmp_path):
    path = tmp_path / "toy.urdf"
    text = TOY.replace("package://toy", str(toy.parent.parent))
    path.write_text(text.replace('<joint name="knuckle" type="revolute">', '<joint name="knuckle" type="prismatic">'))
    with pytest.raises(InputError, match=r"joint 'knuckle' slides: .*\[locked\]"):
        read_model(path)
    assert [hinge.name for hinge in read_model(path, {"knuckle": 0.01}).tree.hinges] == ["shoulder", "roll", "wrist"]
