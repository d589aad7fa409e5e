#!/usr/bin/env python3
"""Moves an object of a running peer on a figure eight: how a program outside of peerd drives an object.

Two commands, each in a terminal of its own, from the repository's folder:

    build/release/bin/peerd run -c configs/scenarios/outside.toml --peer a --interface lo --control a.sock
    python3 examples/feed_poses.py

A second peer sees the car go (`--peer b`; `build/release/bin/peerd ctl --control a.sock objects` says where it is).
By default poses go by UDP to 127.0.0.1 port 47480, which the scenario names. With --socket they go through the peer's
control socket, where every message is answered if it is asked to be:

    python3 examples/feed_poses.py --socket a.sock

All members of a message: docs/reference/control-protocol.md#poses.
"""
import argparse
import json
import math
import socket
import time


def figure_eight(t):
    """Where the car is t seconds after the start, and how fast: 12 m long (x), 6 m wide (z), once round in 10 s."""
    w = 2 * math.pi / 10
    position = [6 * math.sin(w * t), 0.0, 3 * math.sin(2 * w * t)]
    velocity = [6 * w * math.cos(w * t), 0.0, 6 * w * math.cos(2 * w * t)]
    # It looks where it goes. In VRML a car's nose points along -z, and turning by `heading` about +y takes -z there.
    heading = math.atan2(-velocity[0], -velocity[2])
    orientation = [0.0, math.sin(heading / 2), 0.0, math.cos(heading / 2)]
    return position, orientation, velocity


def message(name, t, now):
    """One message. The time stamp lets the peer compute where the car is at each of its own ticks."""
    position, orientation, velocity = figure_eight(t)
    return json.dumps({
        "do": "pose",
        "object": name,
        "time_s": now,                    # when this was so: Unix time of this computer
        "position_m": position,           # in the world's frame
        "orientation_xyzw": orientation,  # a unit quaternion, body to world
        "velocity_m_s": velocity,         # may be left out: then it is found from the positions
        "reply": False,                   # nobody here reads one
    }).encode()


def main():
    parser = argparse.ArgumentParser(description="Moves an object of a running peer on a figure eight.")
    parser.add_argument("--object", default="RED", help="its path, as in the scenario (default: RED)")
    parser.add_argument("--udp", default="127.0.0.1:47480", help="the peer's port for poses (default: %(default)s)")
    parser.add_argument("--socket", help="instead of UDP: the peer's control socket")
    parser.add_argument("--hz", type=float, default=30.0, help="poses a second (default: 30)")
    parser.add_argument("--seconds", type=float, default=math.inf, help="how long (default: until Ctrl+C)")
    arguments = parser.parse_args()

    if arguments.socket:
        peer = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        peer.connect(arguments.socket)
    else:
        host, port = arguments.udp.rsplit(":", 1)
        peer = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        peer.connect((host, int(port)))

    start = time.time()
    try:
        while (now := time.time()) - start < arguments.seconds:
            line = message(arguments.object, now - start, now)
            try:
                # By UDP one message is one datagram; in the socket's stream it is one line.
                peer.sendall(line + b"\n" if arguments.socket else line)
            except ConnectionRefusedError:
                pass  # UDP: the peer is not there, or not yet
            time.sleep(1 / arguments.hz)
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
