"""A webcam joins `sot live udp://127.0.0.1:14044`: MediaPipe's 33 landmarks as positions with names.

pip install mediapipe opencv-python; python docs/examples/live_mediapipe.py pose_landmarker_full.task
"""

import json
import socket
import sys
import time

import cv2
import mediapipe as mp

JOINTS = {  # canonical name -> landmark, in an order in which parents come first
    "head": 0,
    **{
        f"{side}_{joint}": 11 + 2 * k + s
        for k, joint in enumerate(("shoulder", "elbow", "wrist"))
        for s, side in enumerate(("left", "right"))
    },
    **{
        f"{side}_{joint}": 23 + 2 * k + s
        for k, joint in enumerate(("hip", "knee", "ankle"))
        for s, side in enumerate(("left", "right"))
    },
    "left_toe": 31,
    "right_toe": 32,
}
NAMES = ["pelvis", "chest", *JOINTS]
ABOVE = {
    "shoulder": "chest",
    "elbow": "shoulder",
    "wrist": "elbow",
    "hip": "pelvis",
    "knee": "hip",
    "ankle": "knee",
    "toe": "ankle",
}


def parent(name):
    if name in ("pelvis", "chest", "head"):
        return {"pelvis": -1, "chest": 0, "head": 1}[name]
    side, joint = name.split("_")
    above = ABOVE[joint]
    return NAMES.index(above if above in NAMES else f"{side}_{above}")


def position(landmark):
    """Metres, X right of the picture, Y down, Z away -> X forward (at the camera), Y left, Z up."""
    return [-landmark.z, landmark.x, -landmark.y]


stream = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
tasks = mp.tasks.vision
options = tasks.PoseLandmarkerOptions(mp.tasks.BaseOptions(sys.argv[1]), running_mode=tasks.RunningMode.VIDEO)
camera, began, sequence = cv2.VideoCapture(0), time.monotonic(), 0
with tasks.PoseLandmarker.create_from_options(options) as landmarker:
    while camera.isOpened():
        has_picture, picture = camera.read()
        if not has_picture:
            break
        stamp = time.monotonic() - began
        image = mp.Image(mp.ImageFormat.SRGB, cv2.cvtColor(picture, cv2.COLOR_BGR2RGB))
        people = landmarker.detect_for_video(image, int(1000 * stamp)).pose_world_landmarks
        if not people:
            continue
        at = {name: position(people[0][k]) for name, k in JOINTS.items()}
        for middle, ends in (("pelvis", "hip"), ("chest", "shoulder")):
            at[middle] = [0.5 * (a + b) for a, b in zip(at[f"left_{ends}"], at[f"right_{ends}"], strict=True)]
        frame = {
            "sot": 1,
            "type": "frame",
            "sequence": sequence,
            "stamp": stamp,
            "joints": NAMES,
            "parents": [parent(name) for name in NAMES],
            "positions": [at[name] for name in NAMES],
        }
        stream.sendto(json.dumps(frame).encode(), ("127.0.0.1", 14044))
        sequence += 1
