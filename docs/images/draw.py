#!/usr/bin/env python3
"""Draws the pictures of docs/concepts.md into this folder: docs/images/draw.py. The SVG files are committed."""
import math
import pathlib

FOLDER = pathlib.Path(__file__).parent
INK, GREY, BLUE, ORANGE, GREEN, RED = "#222222", "#888888", "#1f6fb2", "#d9730d", "#2e8540", "#b3261e"
PALE_BLUE, PALE_ORANGE, PALE_GREEN, PALE_GREY = "#dcebf7", "#fbe7d2", "#dff0e0", "#eeeeee"


class Picture:
    def __init__(self, width, height):
        self.size = width, height
        self.parts = []

    def line(self, x1, y1, x2, y2, color=INK, width=1.5, dash=None, arrow=False):
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        head = f' marker-end="url(#{color[1:]})"' if arrow else ""
        self.parts.append(f'<line x1="{x1:g}" y1="{y1:g}" x2="{x2:g}" y2="{y2:g}" stroke="{color}" stroke-width="{width}"{dashed}{head}/>')

    def path(self, points, color=INK, width=2, dash=None):
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        text = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self.parts.append(f'<polyline points="{text}" fill="none" stroke="{color}" stroke-width="{width}"{dashed}/>')

    def box(self, x, y, w, h, fill="white", stroke=INK, radius=6, width=1.5, dash=None):
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        self.parts.append(f'<rect x="{x:g}" y="{y:g}" width="{w:g}" height="{h:g}" rx="{radius}" fill="{fill}" stroke="{stroke}" stroke-width="{width}"{dashed}/>')

    def dot(self, x, y, r=4, fill=INK, stroke="none"):
        self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{r:g}" fill="{fill}" stroke="{stroke}" stroke-width="1.5"/>')

    def text(self, x, y, words, color=INK, size=14, anchor="middle", weight="normal"):
        words = words.replace("&", "&amp;").replace("<", "&lt;")
        self.parts.append(f'<text x="{x:g}" y="{y:g}" fill="{color}" font-size="{size}" text-anchor="{anchor}" font-weight="{weight}">{words}</text>')

    def save(self, name, title):
        width, height = self.size
        heads = "".join(
            f'<marker id="{c[1:]}" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="8" markerHeight="8" orient="auto">'
            f'<path d="M0,0 L10,5 L0,10 z" fill="{c}"/></marker>' for c in (INK, GREY, BLUE, ORANGE, GREEN, RED))
        body = "\n".join(self.parts)
        (FOLDER / name).write_text(
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
            f'font-family="sans-serif" role="img"><title>{title}</title><defs>{heads}</defs>\n'
            f'<rect width="{width}" height="{height}" fill="white"/>\n{body}\n</svg>\n')


def peers():
    p = Picture(720, 300)
    for x, name, owned, color, pale in ((20, "peer a, id 1", "CAR", BLUE, PALE_BLUE), (260, "peer b, id 2", "CUBE_1", ORANGE, PALE_ORANGE),
                                        (500, "peer c, id 3", "", GREEN, PALE_GREEN)):
        p.box(x, 20, 200, 170, "white", color)
        p.text(x + 100, 42, name, color, weight="bold")
        for row, (thing, owner, c, fill) in enumerate((("CAR", "CAR", BLUE, PALE_BLUE), ("CUBE_1", "CUBE_1", ORANGE, PALE_ORANGE))):
            mine = owned == owner
            p.box(x + 20, 56 + 42 * row, 160, 32, fill if mine else "white", c, dash=None if mine else "5,4")
            p.text(x + 100, 77 + 42 * row, thing + (": own object" if mine else ": ghost"), c)
        p.box(x + 20, 140, 160, 32, PALE_GREY, GREY)
        p.text(x + 100, 161, "WALL: scene object", GREY)
        p.line(x + 85, 232, x + 85, 192, color, arrow=True)
        p.line(x + 115, 192, x + 115, 232, color, arrow=True)
    p.box(20, 234, 680, 46, PALE_GREY, GREY)
    p.text(360, 262, "multicast group: updates, hellos, decisions. No server.")
    p.save("peers.svg", "Three peers with a replica each, joined by a multicast group")


def ghost():
    p = Picture(720, 330)
    tolerance, scale, speed = 22.0, 1.0, 1.9

    def truth(t):
        return 40 + t * speed, 190 - 70 * math.sin(t / 62.0) - 28 * math.sin(t / 29.0)

    def velocity(t):
        return speed, -70 / 62.0 * math.cos(t / 62.0) - 28 / 29.0 * math.cos(t / 29.0)
    steps = [0.5 * i for i in range(int(660 / speed * 2))]
    base, updates, segments = 0.0, [0.0], [[]]
    for t in steps:
        x, y = truth(base)
        vx, vy = velocity(base)
        g = x + vx * (t - base), y + vy * (t - base)
        segments[-1].append(g)
        if math.dist(g, truth(t)) > tolerance * scale:
            base = t
            updates.append(t)
            segments.append([truth(t)])
    for s in segments:
        p.path(s, ORANGE, 2.5, "7,4")
    p.path([truth(t) for t in steps], BLUE, 2.5)
    for t in updates:
        p.dot(*truth(t), 5, INK)
    jump = segments[0][-1]
    p.line(jump[0], jump[1], *segments[1][0], RED, 1.5)
    p.text(jump[0] - 8, jump[1] - 10, "error = threshold: an update", RED, 13)
    p.line(40, 24, 90, 24, BLUE, 2.5)
    p.text(98, 29, "truth: the object at its owner", BLUE, anchor="start")
    p.line(320, 24, 370, 24, ORANGE, 2.5, "7,4")
    p.text(378, 29, "ghost: the same on every peer, the owner too", ORANGE, anchor="start")
    p.dot(45, 306, 5)
    p.text(60, 311, f"an update: {len(updates)} of them here, instead of one for each frame", anchor="start")
    p.save("ghost.svg", "An object's path, its ghost, and the updates that the threshold asks for")


def prediction():
    p = Picture(720, 270)
    wall, start, y0, y1 = 500, 60, 70, 190
    for y, name in ((y0, "owner"), (y1, "observer, 100 ms away")):
        p.text(130, y - 24, name, anchor="start", weight="bold")
        p.line(wall, y - 30, wall, y + 44, INK, 4)
        p.line(start, y, wall - 12, y, BLUE if y == y0 else ORANGE, 2.5, None if y == y0 else "7,4", arrow=True)
        p.line(wall - 12, y + 18, 250, y + 18, BLUE if y == y0 else ORANGE, 2.5, None if y == y0 else "7,4", arrow=True)
        p.dot(start, y, 5)
        p.dot(wall - 6, y + 9, 5, RED)
    p.text(start, y0 - 12, "update", size=13, anchor="start")
    p.line(start + 4, y0 + 8, start + 40, y1 - 8, GREY, 1.5, arrow=True)
    p.text(start + 30, (y0 + y1) / 2 + 2, "one datagram", GREY, 13, "start")
    p.text(wall + 16, y0 + 6, "contact time, computed", RED, 13, "start")
    p.text(wall + 16, y0 + 24, "from the update alone", RED, 13, "start")
    p.text(wall + 16, y1 + 6, "the same contact time,", RED, 13, "start")
    p.text(wall + 16, y1 + 24, "to the nanosecond", RED, 13, "start")
    p.text(360, 258, "The bounce costs no update: the ghost bounces at its owner and at every observer.", size=13)
    p.save("prediction.svg", "A predicted collision with a wall, at the owner and at an observer")


def decision():
    p = Picture(720, 330)
    ya, yb = 70, 240
    p.text(470, 24, "peer a (owns A): the decider", BLUE, anchor="start", weight="bold")
    p.text(20, yb + 62, "peer b (owns B)", ORANGE, anchor="start", weight="bold")
    p.line(20, ya, 700, ya, BLUE, 1.5, arrow=True)
    p.line(20, yb, 700, yb, ORANGE, 1.5, arrow=True)
    p.line(130, ya, 230, yb, GREY, 1.2, "4,4", arrow=True)
    p.line(130, yb, 230, ya, GREY, 1.2, "4,4", arrow=True)
    p.text(130, (ya + yb) / 2 - 22, "updates of A and B", GREY, 13)
    p.line(150, 40, 150, yb + 30, GREEN, 1.2, "6,4")
    p.text(150, 32, "states that both know select the decider", GREEN, 13, "middle")
    p.line(330, 50, 330, yb + 30, RED, 1.5)
    p.text(330, yb + 46, "contact time t", RED, 13)
    p.line(326, yb + 20, 154, yb + 20, GREEN, 1.2, arrow=True)
    p.text(240, yb + 37, "lookback", GREEN, 13)
    p.dot(330, ya, 6, BLUE)
    p.dot(330, yb, 6, "white", ORANGE)
    p.text(342, ya - 10, "A's response is final: a decision is sent", BLUE, 13, "start")
    p.text(342, yb + 20, "deferred: B goes on, its ghost bounces", ORANGE, 13, "start")
    p.line(345, ya + 4, 520, yb - 6, BLUE, 2, arrow=True)
    p.text(446, (ya + yb) / 2 - 8, "DecisionRecord:", INK, 13, "start")
    p.text(446, (ya + yb) / 2 + 10, "states before and after", INK, 13, "start")
    p.dot(522, yb, 6, ORANGE)
    p.text(532, yb - 12, "applied as of t", ORANGE, 13, "start")
    p.save("decision.svg", "Two peers find one collision; one of them decides it")


def regions():
    p = Picture(720, 330)
    cell, left, top = 62, 24, 24
    cx, cy, r = left + 2.4 * cell, top + 2.3 * cell, 84
    for i in range(7):
        for j in range(4):
            x, y = left + i * cell, top + j * cell
            dx = max(x - cx, 0, cx - x - cell)
            dy = max(y - cy, 0, cy - y - cell)
            touched = dx * dx + dy * dy <= r * r
            p.box(x, y, cell, cell, PALE_BLUE if touched else "white", GREY, 0, 1)
            p.text(x + 12, y + 16, str(1 + i % 4 + 4 * j), GREY, 11)
    p.dot(cx, cy, 5, BLUE)
    p.parts.append(f'<circle cx="{cx}" cy="{cy}" r="{r}" fill="none" stroke="{BLUE}" stroke-width="2"/>')
    ox, oy = left + 4.5 * cell, top + 1.5 * cell
    p.line(ox, oy, ox + 1.1 * cell, oy, ORANGE, 2, arrow=True)
    p.dot(ox, oy, 6, ORANGE)
    x = left + 7 * cell + 22
    p.text(x, 50, "Each cell's updates go to the", size=13, anchor="start")
    p.text(x, 68, "multicast group of its region.", size=13, anchor="start")
    p.text(x, 100, "Numbers repeat: four columns", GREY, 13, "start")
    p.text(x, 118, "of regions cover any plain.", GREY, 13, "start")
    p.text(x, 150, "The area of interest: this peer", BLUE, 13, "start")
    p.text(x, 168, "joins the groups that it touches.", BLUE, 13, "start")
    p.text(x, 200, "An object enters another cell:", ORANGE, 13, "start")
    p.text(x, 218, "its update goes to the new group,", ORANGE, 13, "start")
    p.text(x, 236, "a Handover to the old one.", ORANGE, 13, "start")
    p.text(360, 310, "Hellos and decisions go to region 0, which every peer listens to.", size=13)
    p.save("regions.svg", "A plain cut into cells, an area of interest and a handover")


def clock():
    p = Picture(720, 300)
    ya, yb = 70, 220
    p.text(20, ya - 30, "leader (lowest id): session time = its clock + a constant", BLUE, anchor="start", weight="bold")
    p.text(20, yb + 44, "follower: slews its session time towards the leader's", ORANGE, anchor="start", weight="bold")
    p.line(20, ya, 700, ya, BLUE, 1.5, arrow=True)
    p.line(20, yb, 700, yb, ORANGE, 1.5, arrow=True)
    p.line(100, yb, 240, ya, ORANGE, 2, arrow=True)
    p.line(380, ya, 520, yb, BLUE, 2, arrow=True)
    for x, y, label, dy in ((100, yb, "t1", 20), (240, ya, "t2", -10), (380, ya, "t3", -10), (520, yb, "t4", 20)):
        p.dot(x, y, 5)
        p.text(x, y + dy, label, weight="bold")
    p.text(150, (ya + yb) / 2 + 6, "hello", ORANGE, 13, "end")
    p.text(470, (ya + yb) / 2, "hello with an echo:", BLUE, 13, "start")
    p.text(470, (ya + yb) / 2 + 18, "hold time t3 - t2, session time t3", BLUE, 13, "start")
    p.line(246, ya + 14, 374, ya + 14, GREY, 1.2, arrow=True)
    p.text(310, ya + 32, "hold time", GREY, 13)
    p.text(360, 290, "leader's minus follower's clock lies in [t3 - t4, t2 - t1]; all hellos together narrow this interval", size=13)
    p.save("clock.svg", "The four time stamps of a hello and its echo")


def scene():
    p = Picture(720, 300)

    def node(x, y, name, kind, fill="white", stroke=INK):
        p.box(x - 72, y - 20, 144, 40, fill, stroke)
        p.text(x, y - 3, name, size=13, weight="bold")
        p.text(x, y + 13, kind, GREY, 12)
    top = (110, 280, 450)
    p.text(24, 34, "top level of the world", GREY, 13, "start")
    p.line(24, 44, 530, 44, GREY)
    for x, name, fill, stroke in zip(top, ("CAR", "CUBE_1", "WALL"), (PALE_BLUE, PALE_ORANGE, PALE_GREY), (BLUE, ORANGE, GREY)):
        p.line(x, 44, x, 70, GREY)
        node(x, 90, name, "Transform", fill, stroke)
        p.line(x, 110, x, 140, GREY)
        node(x, 160, "Shape", "geometry, appearance")
    p.box(560, 70, 144, 40, "white", RED)
    p.text(632, 87, "CollisionInterest", RED, 13, weight="bold")
    p.text(632, 103, "WITNESS", GREY, 12)
    p.line(560, 84, 526, 84, RED, 1.5, arrow=True)
    p.text(632, 132, "collider CAR", RED, 12)
    p.text(632, 150, "collidees CUBE_1, WALL", RED, 12)
    p.text(360, 222, "An object is a node that an interest names or a peer owns, with all below it.", size=13)
    p.text(360, 244, "Blue and orange: owned by two peers. Grey: a scene object, owned by nobody.", size=13)
    p.text(360, 266, "Pairs that no interest names are never tested, and nothing is built for them.", size=13)
    p.save("scene.svg", "A scene, its objects and one collision interest")


if __name__ == "__main__":
    for draw in (peers, ghost, prediction, decision, regions, clock, scene):
        draw()
