"""The bridges of docs/examples, with what they talk to made up: what they send is a person that a robot can follow."""

import json
import runpy
import socket
import sys
from contextlib import closing
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sot.live.person import MIN_CALIBRATION_FRAMES, Acquaintance
from sot.live.streams.json_udp import JsonUdpSource

FOLDER = Path(__file__).parents[1] / "docs" / "examples"
PORT = 14044
FRAMES = 60
STANDING = {  # a person 1.7 m tall who faces along X, [m]
    "pelvis": (0.0, 0.0, 0.95),
    "chest": (0.0, 0.0, 1.4),
    "head": (0.05, 0.0, 1.6),
    **{
        f"{side}_{joint}": (x, sign * y, z)
        for side, sign in (("left", 1.0), ("right", -1.0))
        for joint, x, y, z in (
            ("shoulder", 0.0, 0.18, 1.4),
            ("elbow", 0.0, 0.2, 1.1),
            ("wrist", 0.1, 0.2, 0.87),
            ("hip", 0.0, 0.1, 0.95),
            ("knee", 0.02, 0.1, 0.5),
            ("ankle", 0.0, 0.1, 0.08),
            ("toe", 0.15, 0.1, 0.02),
        )
    },
}


class NoMoreMessagesError(Exception):
    """There are no more messages."""


@pytest.fixture
def receiver(monkeypatch):
    """A source; what is sent to the bridges' port arrives there."""
    with closing(JsonUdpSource("127.0.0.1", 0, joints=("knee",))) as source:

        class Redirected(socket.socket):
            def sendto(self, content, to):
                assert to == ("127.0.0.1", PORT)
                return super().sendto(content, ("127.0.0.1", source.port))

        monkeypatch.setattr(socket, "socket", Redirected)
        yield source


def module(monkeypatch, name, **contents):
    made = ModuleType(name)
    made.__dict__.update(contents)
    monkeypatch.setitem(sys.modules, name, made)
    return made


def bridged(name, monkeypatch, *arguments):
    monkeypatch.setattr(sys, "argv", [name, *arguments])
    return runpy.run_path(str(FOLDER / name))


def check_person(frames, rotations=False):
    assert len(frames) >= MIN_CALIBRATION_FRAMES
    assert [frame.sequence for frame in frames] == list(range(len(frames)))
    for joint, place in STANDING.items():
        np.testing.assert_allclose(frames[0].positions[frames[0].skeleton.joints.index(joint)], place, atol=1e-4)
    assert (frames[0].rotations is not None) == rotations
    acquaintance = Acquaintance("a bridge")
    assert any(acquaintance.add(frame) is not None for frame in frames)


def test_mediapipe(receiver, monkeypatch):
    arrived, pictures = [], iter(range(FRAMES))
    landmarks = [SimpleNamespace(x=0.0, y=0.0, z=0.0)] * 33
    order = ("shoulder", "elbow", "wrist"), ("hip", "knee", "ankle")
    numbers = {"head": 0, "left_toe": 31, "right_toe": 32}
    for first, joints in zip((11, 23), order, strict=True):
        numbers |= {
            f"{s}_{j}": first + 2 * k + i for k, j in enumerate(joints) for i, s in enumerate(("left", "right"))
        }
    for joint, number in numbers.items():  # X right of the picture, Y down, Z away; the person faces the camera
        x, y, z = STANDING[joint]
        landmarks[number] = SimpleNamespace(x=y, y=-z, z=-x)

    class Landmarker:
        def __enter__(self):
            return self

        def __exit__(self, *error):
            return None

        def detect_for_video(self, image, stamp_ms):
            assert isinstance(stamp_ms, int)
            arrived.extend(receiver.poll(0.02 * len(arrived)))
            return SimpleNamespace(pose_world_landmarks=[landmarks] if stamp_ms >= 0 else [])

    clock = iter(0.02 * np.arange(10 * FRAMES))
    monkeypatch.setattr("time.monotonic", lambda: float(next(clock)))
    vision = SimpleNamespace(
        PoseLandmarker=SimpleNamespace(create_from_options=lambda options: Landmarker()),
        PoseLandmarkerOptions=lambda base, running_mode: base,
        RunningMode=SimpleNamespace(VIDEO="video"),
    )
    tasks = SimpleNamespace(vision=vision, BaseOptions=lambda path: path)
    image = {"Image": lambda form, picture: picture, "ImageFormat": SimpleNamespace(SRGB=1)}
    module(monkeypatch, "mediapipe", tasks=tasks, **image)
    camera = SimpleNamespace(isOpened=lambda: True, read=lambda: (next(pictures, None) is not None, "picture"))
    module(monkeypatch, "cv2", VideoCapture=lambda k: camera, cvtColor=lambda picture, code: picture, COLOR_BGR2RGB=4)
    bridged("live_mediapipe.py", monkeypatch, "model.task")
    check_person(arrived + receiver.poll(2.0))


def test_zeromq(receiver, monkeypatch):
    arrived, names = [], list(STANDING)
    sent = iter(range(FRAMES))

    class Subscriber:
        def setsockopt(self, option, value):
            assert option in ("subscribe", "hwm")

        def connect(self, address):
            assert address == "tcp://127.0.0.1:5556"

        def recv_multipart(self):
            arrived.extend(receiver.poll(0.02 * len(arrived)))
            k = next(sent, None)
            if k is None:
                raise NoMoreMessagesError
            above = {"chest": "pelvis", "head": "chest"}
            for side in ("left", "right"):
                for first, *chain in (
                    ("chest", "shoulder", "elbow", "wrist"),
                    ("pelvis", "hip", "knee", "ankle", "toe"),
                ):
                    links = [first, *(f"{side}_{joint}" for joint in chain)]
                    above |= dict(zip(links[1:], links, strict=False))
            parents = [names.index(above[name]) if name in above else -1 for name in names]
            turns = [[0.0, 0.0, 0.0, 1.0]] * len(names)
            pose = {"stamp": 0.02 * k, "names": names, "parents": parents, "positions": list(STANDING.values())}
            return b"pose", json.dumps({**pose, "rotations": turns}).encode()

    context = SimpleNamespace(socket=lambda kind: Subscriber())
    module(monkeypatch, "zmq", Context=lambda: context, SUB=1, SUBSCRIBE="subscribe", RCVHWM="hwm")
    with pytest.raises(NoMoreMessagesError):
        bridged("live_zeromq.py", monkeypatch, "tcp://127.0.0.1:5556")
    check_person(arrived + receiver.poll(2.0), rotations=True)


def test_ros2(receiver, monkeypatch):
    arrived, published, timers, looked_up = [], [], [], []
    time = SimpleNamespace(now=0.0)

    unavailable = type("TransformException", (Exception,), {})

    class Buffer:
        def lookup_transform(self, world, name, at):
            looked_up.append(name)
            if time.now < 0.1:
                raise unavailable("nobody is there")
            x, y, z = STANDING[name]
            turn = dict(zip("xyzw", Rotation.identity().as_quat(), strict=True))
            place = SimpleNamespace(x=x, y=y, z=z)
            return SimpleNamespace(transform=SimpleNamespace(translation=place, rotation=SimpleNamespace(**turn)))

    class Node:
        def __init__(self, name):
            self.name = name

        def create_publisher(self, kind, topic, depth):
            return SimpleNamespace(publish=published.append)

        def create_timer(self, period, call):
            timers.append((period, call))

        def get_clock(self):
            return SimpleNamespace(now=lambda: SimpleNamespace(nanoseconds=int(1e9 * time.now)))

    def spin(node):
        (_, send), (_, subscribe) = timers
        subscribe()
        for k in range(FRAMES):
            time.now = 0.02 * k
            send()
            arrived.extend(receiver.poll(time.now))
            for _ in range(2):
                receiver.reply(time.now, np.array([0.01 * k]))

    module(monkeypatch, "rclpy", init=lambda: None, spin=spin)
    module(monkeypatch, "rclpy.node", Node=Node)
    module(monkeypatch, "rclpy.time", Time=lambda: None)
    module(monkeypatch, "sensor_msgs")
    module(monkeypatch, "sensor_msgs.msg", JointState=lambda name, position: (name, position))
    listener = {"TransformListener": lambda buffer, node: None, "TransformException": unavailable}
    module(monkeypatch, "tf2_ros", Buffer=Buffer, **listener)
    bridged("live_ros2.py", monkeypatch)
    check_person(arrived, rotations=True)
    assert set(looked_up) == set(STANDING)
    assert published[-1] == (["knee"], [pytest.approx(0.01 * (FRAMES - 2))])  # none waits
    assert len(published) >= 2 * (FRAMES - 2)
