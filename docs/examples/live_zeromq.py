"""A ZeroMQ publisher of poses joins `sot live udp://127.0.0.1:14044`: its messages become frames.

pip install pyzmq; python docs/examples/live_zeromq.py tcp://127.0.0.1:5556

Expects multipart messages: a topic "pose", then JSON with "stamp" [s], "names", "parents", "positions" [m, Z up], and,
if there are any, "rotations" (quaternions xyzw).
"""

import json
import socket
import sys

import zmq

TOPIC = b"pose"
TO = ("127.0.0.1", 14044)

subscriber = zmq.Context().socket(zmq.SUB)
subscriber.setsockopt(zmq.RCVHWM, 2)  # a pose that had to wait longer is of no use
subscriber.setsockopt(zmq.SUBSCRIBE, TOPIC)
subscriber.connect(sys.argv[1])
stream = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
sequence = 0
while True:
    topic, content = subscriber.recv_multipart()
    pose = json.loads(content)
    frame = {
        "sot": 1,
        "type": "frame",
        "sequence": sequence,
        "stamp": pose["stamp"],
        "joints": pose["names"],
        "parents": pose["parents"],
        "positions": pose["positions"],
    }
    if "rotations" in pose:
        frame["rotations"] = pose["rotations"]
    stream.sendto(json.dumps(frame).encode(), TO)
    sequence += 1
