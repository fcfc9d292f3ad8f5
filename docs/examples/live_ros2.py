"""ROS 2's transforms of a tracked person join `sot live udp://127.0.0.1:14044`, and joint targets come back.

In a sourced ROS 2 environment: python docs/examples/live_ros2.py
"""

import itertools
import json
import socket

import rclpy
from rclpy.node import Node
from rclpy.time import Time
from sensor_msgs.msg import JointState
from tf2_ros import Buffer, TransformException, TransformListener

TO, FRAME_RATE, WORLD = ("127.0.0.1", 14044), 50.0, "world"
CHAINS = [
    ("pelvis", "chest", "head"),
    *(("chest", f"{s}_shoulder", f"{s}_elbow", f"{s}_wrist") for s in ("left", "right")),
    *(("pelvis", f"{s}_hip", f"{s}_knee", f"{s}_ankle", f"{s}_toe") for s in ("left", "right")),
]
PARENT = {below: above for chain in CHAINS for above, below in itertools.pairwise(chain)}
NAMES = ["pelvis", *PARENT]


class Bridge(Node):
    """Sends transforms named like the canonical joints, and publishes the robot's targets as joint states."""

    def __init__(self):
        super().__init__("sot_bridge")
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.publisher = self.create_publisher(JointState, "sot/joint_targets", 1)
        self.stream = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.stream.setblocking(False)
        self.sequence = 0
        self.create_timer(1.0 / FRAME_RATE, self.send)
        self.create_timer(1.0, lambda: self.stream.sendto(b'{"sot":1,"type":"subscribe"}', TO))

    def send(self):
        self.publish_targets()
        try:
            found = [self.buffer.lookup_transform(WORLD, name, Time()).transform for name in NAMES]
        except TransformException:
            return  # nobody is tracked yet
        frame = {
            "sot": 1,
            "type": "frame",
            "sequence": self.sequence,
            "joints": NAMES,
            "stamp": 1e-9 * self.get_clock().now().nanoseconds,
            "parents": [NAMES.index(PARENT[name]) if name in PARENT else -1 for name in NAMES],
            "positions": [[t.translation.x, t.translation.y, t.translation.z] for t in found],
            "rotations": [[t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w] for t in found],
        }
        self.stream.sendto(json.dumps(frame).encode(), TO)
        self.sequence += 1

    def publish_targets(self):
        """Targets come twice as often as frames go: publish all that wait, or they would grow old."""
        while True:
            try:
                told = json.loads(self.stream.recv(65507))
            except BlockingIOError:
                return
            if told.get("type") == "targets":
                self.publisher.publish(JointState(name=told["joints"], position=told["positions"]))


rclpy.init()
rclpy.spin(Bridge())
