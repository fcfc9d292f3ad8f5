"""Streams of a person over the network: receivers that trust nobody, and senders that play a clip as a stream."""
