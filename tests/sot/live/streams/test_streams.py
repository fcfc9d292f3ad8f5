"""Streams over loopback sockets: what is sent arrives, and what is malformed or hostile is counted and dropped."""

import json
import random
import socket
import tracemalloc
from contextlib import closing

import lz4.frame
import numpy as np
import pytest

from sot.errors import InputError
from sot.live.streams import json_udp, rokoko, vmc
from sot.live.streams.address import Sender, StreamAddress
from sot.live.streams.json_udp import JsonUdpSource
from sot.live.streams.rokoko import RokokoSource
from sot.live.streams.vmc import VmcSource
from tests.sot.live.streams.clips import frames

SOURCES = {"udp": JsonUdpSource, "vmc": VmcSource, "rokoko": RokokoSource}
ENCODERS = {"udp": json_udp.encoded_frame, "vmc": vmc.encoded_frame, "rokoko": rokoko.encoded_frame}
SCHEMES = list(SOURCES)
MAX_GROWTH_BYTES = 5_000_000


def receiver(scheme):
    return closing(SOURCES[scheme]("127.0.0.1", 0))


def sender(port):
    made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    made.connect(("127.0.0.1", port))
    return closing(made)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_what_is_sent_arrives(scheme):
    sent = frames(scheme, 0.2)
    with receiver(scheme) as source:
        to = Sender(StreamAddress(scheme, "127.0.0.1", source.port))
        got = []
        for k, frame in enumerate(sent):
            to.send(frame)
            got += source.poll(0.02 * k)
        to.close()
    # the last one of VMC's first frame is known by the next one's beginning
    assert len(got) == len(sent)
    for one, other in zip(sent, got, strict=True):
        joints = [other.skeleton.joints.index(name) for name in one.skeleton.joints]
        assert np.abs(other.positions[joints] - one.positions).max() < 1e-4
        assert np.abs(other.rotations[joints] - one.rotations).max() < 1e-4
        assert other.stamp == pytest.approx(one.stamp, abs=1e-6)


def test_a_vmc_frame_spans_several_datagrams_in_any_order_and_needs_no_time():
    first, second = frames("vmc", 0.02)
    datagrams = [vmc.encoded_frame(first), vmc.encoded_frame(second)]
    assert len(datagrams[0]) > 1
    with receiver("vmc") as source, sender(source.port) as to:
        for content in datagrams[0]:
            to.send(content)
        assert source.poll(0.0) == []  # nobody knows yet which bones there are
        for content in datagrams[1]:
            to.send(content)
        (one, other) = source.poll(0.02)
    assert (
        np.abs(one.positions - first.positions[[first.skeleton.joints.index(j) for j in one.skeleton.joints]]).max()
        < 1e-4
    )
    assert other.sequence == one.sequence + 1


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("kind", ["random", "mutated"])
@pytest.mark.parametrize("count", [200, pytest.param(10_000, marks=pytest.mark.slow)])
def test_hostile_datagrams_are_counted_and_dropped(scheme, kind, count):
    """Decoded directly: the bound of the rate would drop them."""
    chance = random.Random(7)
    real = [content for frame in frames(scheme, 0.1) for content in ENCODERS[scheme](frame)]

    def mutated(content):
        changed = bytearray(content)
        for _ in range(chance.randint(1, 8)):
            changed[chance.randrange(len(changed))] = chance.randrange(256)
        return bytes(changed[: chance.randint(1, len(changed))] if chance.random() < 0.3 else changed)

    with receiver(scheme) as source:
        for content in real:  # what is made once does not count as growth
            source._decode(content, ("127.0.0.1", 1))
        tracemalloc.start()
        before = tracemalloc.get_traced_memory()[0]
        for _ in range(count):
            noise = chance.randbytes(chance.randint(0, 400)) if kind == "random" else mutated(chance.choice(real))
            source._decode(noise, ("127.0.0.1", 1))
            for frame in source._frames:
                assert frame.is_finite
            source._frames = []
        growth = tracemalloc.get_traced_memory()[0] - before
        tracemalloc.stop()
        assert growth < MAX_GROWTH_BYTES
        assert source.counts.total() > 0.2 * count
        assert len(source.counts) < 20


HOSTILE_JSON = [
    b"[" * 30_000,
    b'{"sot":1,"type":"frame","sequence":1e999}',
    b'{"sot":1,"joints":' + b"9" * 5000 + b"}",
    json.dumps({"sot": 1, "joints": ["a"] * 200, "parents": [-1] * 200}).encode(),
    json.dumps({"sot": 1, "joints": ["a", "b"], "parents": [1, -1]}).encode(),
    json.dumps({"sot": 1, "joints": ["a"], "parents": [-1], "positions": [[1, 2]], "stamp": 0, "sequence": 0}).encode(),
    b'{"sot":1,"joints":["a"],"parents":[-1],"positions":[[NaN,0,0]],"stamp":0,"sequence":0}',
    b'{"sot":1,"joints":["a"],"parents":[-1],"positions":[[1e9,0,0]],"stamp":0,"sequence":0}',
    b'{"sot":1,"joints":["a"],"parents":[-1],"positions":[[true,0,0]],"stamp":0,"sequence":0}',
    b'{"sot":1,"joints":["a"],"parents":[-1],"positions":[[0,0,0]],"rotations":[[0,0,0,0]],"stamp":0,"sequence":0}',
    b'{"sot":2}',
    b"null",
]


@pytest.mark.parametrize("content", HOSTILE_JSON)
def test_hostile_json_is_refused(content):
    with receiver("udp") as source, sender(source.port) as to:
        to.send(content)
        assert source.poll(0.0) == []
        assert source.counts.total() == 1


def test_a_datagram_that_decompresses_without_end_is_refused():
    with receiver("rokoko") as source, sender(source.port) as to:
        to.send(lz4.frame.compress(b" " * 10_000_000))
        assert source.poll(0.0) == []
        assert source.counts["too long"] == 1


def test_the_first_sender_keeps_the_stream_until_it_is_silent():
    (content,) = json_udp.encoded_frame(frames("udp", 0.0)[0])
    with receiver("udp") as source, sender(source.port) as first, sender(source.port) as second:
        second.send(b"noise")  # does not make it the sender
        first.send(content)
        assert len(source.poll(0.0)) == 1
        second.send(content)
        assert source.poll(0.5) == [] and source.counts["other sender"] == 1
        second.send(content)
        assert len(source.poll(1.6)) == 1
        first.send(content)
        assert source.poll(1.7) == [] and source.counts["other sender"] == 2


def test_too_many_datagrams_are_not_decoded():
    with receiver("udp") as source, sender(source.port) as to:
        for _ in range(300):
            to.send(b"noise")
        source.poll(0.0)
        assert source.counts["not JSON"] <= 200 and source.counts["too many"] > 0


def test_a_wrong_token_is_told_to_its_sender_now_and_then():
    frame = frames("udp", 0.0)[0]
    with closing(JsonUdpSource("127.0.0.1", 0, token="right")) as source:
        to = Sender(StreamAddress("udp", "127.0.0.1", source.port), token="wrong")
        to.send(frame)
        assert source.poll(0.0) == [] and source.counts["wrong token"] == 1
        with pytest.raises(InputError, match="another token"):
            to.check_refused()
        to.close()
        right = Sender(StreamAddress("udp", "127.0.0.1", source.port), token="right")
        right.send(frame)
        assert len(source.poll(0.1)) == 1
        right.close()


def test_who_asks_is_told_joint_targets():
    with closing(JsonUdpSource("127.0.0.1", 0, joints=("a", "b"))) as source, sender(source.port) as asking:
        asking.settimeout(1.0)
        asking.send(b'{"sot":1,"type":"subscribe"}')
        source.poll(0.0)
        source.reply(1.0, np.array([0.5, -0.25]))
        told = json.loads(asking.recv(4096))
        assert told == {"sot": 1, "type": "targets", "stamp": 1.0, "joints": ["a", "b"], "positions": [0.5, -0.25]}
        source.reply(6.0, np.zeros(2))  # it has not asked again
        asking.settimeout(0.05)
        with pytest.raises(TimeoutError):
            asking.recv(4096)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("http://127.0.0.1:1", "unknown stream"),
        ("udp://127.0.0.1:99999", "no address"),
        ("udp://127.0.0.1/there", "nothing after it"),
    ],
)
def test_addresses_that_are_none(text, says):
    with pytest.raises(InputError, match=says):
        StreamAddress.parse(text)


def test_other_machines_are_listened_to_only_if_asked_for():
    with pytest.raises(InputError, match="--bind"):
        StreamAddress.parse("udp://0.0.0.0:0").open()
    StreamAddress.parse("udp://0.0.0.0:0").open(bind="0.0.0.0").close()


def test_a_port_in_use_is_told():
    with receiver("udp") as source, pytest.raises(InputError, match="cannot listen"):
        StreamAddress("udp", "127.0.0.1", source.port).open()
