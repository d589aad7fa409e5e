#!/usr/bin/env python3
"""first_picture.py COMMAND...: starts a peer with a page, and says how long it takes until its first picture is there:
the page, and the scene that the page draws. Prints one line, "first picture after 0.61 s"; the peer is ended."""
import subprocess
import sys
import time
import urllib.error
import urllib.request

GIVES_UP_S = 60.0


def address_in(log):
    for line in log:
        if "http://" in line:
            return line[line.index("http://"):].split("#")[0].strip().rstrip("/")
    raise SystemExit("the peer has ended without a page")


def get_when_there(url, give_up):
    """The scene is made once the peer has begun; until then there is no such thing."""
    while True:
        try:
            with urllib.request.urlopen(url, timeout=GIVES_UP_S) as reply:
                return reply.read()
        except urllib.error.URLError as why:
            if time.monotonic() > give_up:
                raise SystemExit(f"{url}: {why}")
            time.sleep(0.01)


def main():
    begin = time.monotonic()
    peer = subprocess.Popen(sys.argv[1:], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        page = address_in(peer.stdout)
        if b"<script" not in get_when_there(page + "/", begin + GIVES_UP_S):
            raise SystemExit("the page has no program")
        if not get_when_there(page + "/api/v1/scene.glb", begin + GIVES_UP_S).startswith(b"glTF"):
            raise SystemExit("the scene is none")
        print(f"first picture after {time.monotonic() - begin:.2f} s")
    finally:
        peer.terminate()
        peer.wait()


if __name__ == "__main__":
    main()
