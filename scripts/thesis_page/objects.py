"""The objects of the thesis's appendix B: those of a corpus where it has them, else generated ones that resemble them."""
import math
import pathlib
import random

# name: the file of a corpus (tests/README.md, PEERD_CORPUS), or nothing, and what is generated in its place
CORPUS = {"Al": "vrml/standin_Al.wrl", "Galleon": "vrml/standin_Galleon.wrl", "Mustang": "vrml/standin_MustangP51.wrl",
          "Piping": "vrml/choreonoid__pipes.wrl"}
NAMES = ["Al", "Galleon", "3000gt", "Mustang", "Eagle", "Tree", "Piping", "Truck"]


class Mesh:
    def __init__(self):
        self.points, self.polygons = [], []

    def surface(self, at, columns, rows, closed=False):
        """A grid of quads over at(u, v), u and v from 0 to 1, cut into triangles; `closed`: the last column is the first."""
        first = len(self.points)
        width = columns if closed else columns + 1
        for row in range(rows + 1):
            self.points += [at(column / columns, row / rows) for column in range(width)]
        for row in range(rows):
            for column in range(columns):
                a, b = first + row * width + column, first + row * width + (column + 1) % width
                self.polygons += [(a, b, b + width), (a, b + width, a + width)]

    def ellipsoid(self, center, radii, columns, rows):
        def at(u, v):
            sine = math.sin(math.pi * v)
            return tuple(c + r * d for c, r, d in zip(center, radii, (
                sine * math.cos(2 * math.pi * u), math.cos(math.pi * v), sine * math.sin(2 * math.pi * u))))
        self.surface(at, columns, rows, closed=True)

    def tube(self, begin, end, radius, columns, rows, taper=1.0):
        axis = [e - b for b, e in zip(begin, end)]
        length = math.sqrt(sum(a * a for a in axis)) or 1.0
        n = [a / length for a in axis]
        other = (1.0, 0.0, 0.0) if abs(n[0]) < 0.8 else (0.0, 1.0, 0.0)
        u = cross(n, other)
        size = math.sqrt(sum(x * x for x in u))
        u = [x / size for x in u]
        v = cross(n, u)

        def at(s, t):
            r = radius * (1 + (taper - 1) * t)
            c, d = r * math.cos(2 * math.pi * s), r * math.sin(2 * math.pi * s)
            return tuple(b + a * t + c * x + d * y for b, a, x, y in zip(begin, axis, u, v))
        self.surface(at, columns, rows, closed=True)

    def ring(self, center, large, small, columns, rows):
        def at(u, v):
            a, b = 2 * math.pi * u, 2 * math.pi * v
            r = large + small * math.cos(b)
            return (center[0] + r * math.cos(a), center[1] + r * math.sin(a), center[2] + small * math.sin(b))
        self.surface(at, columns, rows, closed=True)

    def sheet(self, origin, u, v, columns, rows, bulge=(0.0, 0.0, 0.0)):
        def at(s, t):
            lift = 16 * s * (1 - s) * t * (1 - t)
            return tuple(o + s * a + t * b + lift * c for o, a, b, c in zip(origin, u, v, bulge))
        self.surface(at, columns, rows)

    def box(self, low, high, cells=1):
        for axis in range(3):
            i, j = (axis + 1) % 3, (axis + 2) % 3
            u, v = [0.0] * 3, [0.0] * 3
            u[i], v[j] = high[i] - low[i], high[j] - low[j]
            for side in (low, high):
                origin = list(low)
                origin[axis] = side[axis]
                self.sheet(origin, u, v, cells, cells)


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def al(mesh, fine):  # a figure: some 7,000 triangles
    n = max(6, round(18 * fine))
    for center, radii in (((0, 1.2, 0), (0.5, 0.7, 0.35)), ((0, 2.3, 0), (0.42, 0.45, 0.42)), ((0, 2.3, 0.45), (0.12, 0.1, 0.15)),
                          ((0.75, 1.4, 0), (0.45, 0.13, 0.13)), ((-0.75, 1.4, 0), (0.45, 0.13, 0.13)),
                          ((1.3, 1.5, 0), (0.22, 0.16, 0.12)), ((-1.3, 1.5, 0), (0.22, 0.16, 0.12)),
                          ((0.22, 0.1, 0), (0.17, 0.6, 0.17)), ((-0.22, 0.1, 0), (0.17, 0.6, 0.17)),
                          ((0.25, -0.5, 0.2), (0.17, 0.12, 0.4)), ((-0.25, -0.5, 0.2), (0.17, 0.12, 0.4))):
        mesh.ellipsoid(center, radii, n, n)


def galleon(mesh, fine):  # a ship: some 4,700 triangles
    n = max(4, round(14 * fine))

    def hull(u, v):
        width = 1.1 * math.sin(math.pi * min(1.0, 0.1 + u)) * (0.35 + 0.65 * v)
        side = 2 * abs(v - 0.5)
        return (8 * u - 4, -1 + 1.6 * side ** 1.5 + 0.8 * (u - 0.5) ** 2, (1 if v > 0.5 else -1) * width * side)
    mesh.surface(hull, 3 * n, 2 * n)
    for x, height in ((-2.2, 3.5), (0.2, 4.5), (2.2, 3.6)):
        mesh.tube((x, -0.8, 0), (x, height, 0), 0.08, 8, n)
        for part in (0.25, 0.6):
            mesh.sheet((x, height * part, -1.2), (0, 0, 2.4), (0, height * 0.3, 0), n, n, (0.5, 0, 0))
    mesh.tube((4, 0.4, 0), (6, 1.2, 0), 0.06, 8, n)


def car(mesh, fine):  # some 13,000 triangles
    n = max(6, round(22 * fine))

    def body(u, v):
        a = 2 * math.pi * u
        x = 2.3 * math.copysign(abs(math.cos(a)) ** 0.4, math.cos(a))
        z = 0.9 * math.copysign(abs(math.sin(a)) ** 0.4, math.sin(a))
        roof = 0.55 * math.exp(-((x + 0.2) / 0.9) ** 2)
        return (x * (1 - 0.12 * v), 0.2 + v * (0.5 + roof), z * (1 - 0.2 * v))
    mesh.surface(body, 3 * n, n, closed=True)
    mesh.sheet((-2.2, 0.22, -0.8), (4.4, 0, 0), (0, 0, 1.6), n, n)
    for x in (-1.45, 1.45):
        for z in (-0.85, 0.85):
            mesh.ring((x, 0.3, z), 0.24, 0.09, 2 * n, n)
            mesh.ellipsoid((x, 0.3, z), (0.17, 0.17, 0.05), n, n // 2)


def mustang(mesh, fine):  # an airplane: some 3,000 triangles
    n = max(4, round(12 * fine))
    mesh.ellipsoid((0, 0, 0), (4.5, 0.6, 0.55), 2 * n, 2 * n)
    for side in (-1, 1):
        mesh.sheet((-0.8, -0.2, 0), (2.0, 0, 0), (-0.5, 0.5, side * 5.5), n, n, (0, 0.12, 0))
        mesh.sheet((-0.8, -0.25, 0), (2.0, 0, 0), (-0.5, 0.5, side * 5.5), n, n, (0, -0.06, 0))
        mesh.sheet((-4.2, 0.1, 0), (1.0, 0, 0), (-0.2, 0.1, side * 1.9), n, n // 2, (0, 0.05, 0))
    mesh.sheet((-4.3, 0, 0), (1.2, 0, 0), (-0.4, 1.6, 0), n, n // 2, (0, 0, 0.05))
    mesh.ellipsoid((0.4, 0.55, 0), (0.9, 0.4, 0.35), n, n)
    for turn in range(4):
        a = turn * math.pi / 2
        mesh.sheet((4.5, 0, 0), (0, 1.6 * math.cos(a), 1.6 * math.sin(a)), (0.05, -0.2 * math.sin(a), 0.2 * math.cos(a)), n, 3)


def eagle(mesh, fine):  # with spread wings of feathers: some 26,000 triangles
    n = max(3, round(9 * fine))
    mesh.ellipsoid((0, 0, 0), (1.8, 0.7, 0.6), 4 * n, 4 * n)
    mesh.ellipsoid((2.0, 0.5, 0), (0.5, 0.4, 0.35), 3 * n, 3 * n)
    mesh.tube((2.3, 0.5, 0), (2.9, 0.3, 0), 0.14, n + 3, n, 0.05)
    for side in (-1, 1):
        mesh.tube((-0.2, -0.5, 0.3 * side), (-0.1, -1.5, 0.4 * side), 0.15, n + 3, n, 0.5)
        for feather in range(60):
            out = 0.3 + 4.4 * feather / 60
            length = 2.0 - 0.1 * (out - 2.2) ** 2
            lift = 0.62 * out - 0.05 * out * out
            mesh.sheet((0.8 - 0.05 * out, lift, side * out), (-length, -0.15, side * (0.25 + 0.1 * out)), (0.05, 0.05, side * 0.13),
                       2 * n, max(2, n // 2), (0, 0.06, 0))
    for feather in range(9):
        mesh.sheet((-1.5, 0, 0.08 * (feather - 4)), (-1.4, -0.3, 0.2 * (feather - 4)), (0, 0.02, 0.1), 2 * n, n)


def tree(mesh, fine):  # branches and leaves: some 45,000 triangles
    numbers = random.Random(1)
    columns = max(4, round(9 * fine))

    def grow(at, heading, length, depth):
        end = tuple(a + length * h for a, h in zip(at, heading))
        mesh.tube(at, end, 0.09 * length, columns, 3, 0.7)
        if depth == 0:
            for _ in range(max(2, round(9 * fine))):
                tip = tuple(e + numbers.uniform(-0.35, 0.35) for e in end)
                u = [numbers.uniform(-0.12, 0.12) for _ in range(3)]
                v = [numbers.uniform(-0.12, 0.12) for _ in range(3)]
                mesh.sheet(tip, u, v, 2, 2, (0, 0.02, 0))
            return
        for _ in range(4 if depth > 1 or fine >= 1 else 3):
            turned = [h + numbers.uniform(-0.75, 0.75) for h in heading]
            turned[1] += 0.15
            size = math.sqrt(sum(x * x for x in turned))
            grow(end, [x / size for x in turned], length * numbers.uniform(0.6, 0.8), depth - 1)
    grow((0, 0, 0), (0, 1, 0), 1.6, 4 if fine >= 1 else 3)


def piping(mesh, fine):  # pipes along a grid: some 40,000 triangles
    numbers = random.Random(2)
    n = max(5, round(14 * fine))
    for _ in range(max(10, round(110 * fine))):
        at = [float(numbers.randrange(6)) for _ in range(3)]
        for _ in range(3):
            axis = numbers.randrange(3)
            to = list(at)
            to[axis] += numbers.choice((-2, -1, 1, 2))
            mesh.tube(at, to, 0.12, n, 4)
            at = to
        mesh.ellipsoid(at, (0.2, 0.2, 0.2), n, n // 2)


def truck(mesh, fine):  # few large plates, and springs of ever smaller triangles: some 42,000 triangles
    n = max(6, round(30 * fine))
    mesh.box((-6, 0.8, -1.25), (2.5, 3.8, 1.25))
    mesh.box((2.8, 0.8, -1.2), (4.8, 3.2, 1.2))
    mesh.box((-6, 0.5, -0.5), (4.8, 0.8, 0.5))
    for x in (-5, -3.8, 3.8):
        for z in (-1.1, 1.1):
            mesh.ring((x, 0.5, z), 0.36, 0.14, n, n // 2)
    for k in range(max(2, round(4 * fine))):  # each coil is smaller than the one before by a fixed ratio
        def spring(u, v, k=k):
            shrink = 0.5 ** (30 * u)
            a, b = 2 * math.pi * 60 * u, 2 * math.pi * v
            r = shrink * (1 + 0.2 * math.cos(b))
            return (3.8 + 0.3 * k + r * math.cos(a), 1.5 + r * math.sin(a), 1.3 + shrink * 0.2 * math.sin(b) + 2 * shrink)
        mesh.surface(spring, round(900 * fine), 5)


BUILDERS = {"Al": al, "Galleon": galleon, "3000gt": car, "Mustang": mustang, "Eagle": eagle, "Tree": tree, "Piping": piping,
            "Truck": truck}


def generated(name, fine):
    mesh = Mesh()
    BUILDERS[name](mesh, fine)
    points = ", ".join(f"{x:.7g} {y:.7g} {z:.7g}" for x, y, z in mesh.points)
    corners = " ".join(f"{a} {b} {c} -1" for a, b, c in mesh.polygons)
    return ("#VRML V2.0 utf8\nShape { geometry IndexedFaceSet { solid FALSE coord Coordinate { point [ " + points +
            " ] } coordIndex [ " + corners + " ] } }\n")


class Object:
    def __init__(self, name, path, origin):
        self.name, self.path, self.origin = name, path, origin  # origin: a few words


def find(folder, corpus, quick):
    """The eight objects as files: of the corpus, or generated into the folder; --quick: small generated ones alone."""
    out = []
    for name in NAMES:
        real = pathlib.Path(corpus) / CORPUS[name] if corpus and name in CORPUS and not quick else None
        if real and real.is_file():
            out.append(Object(name, real, f"{real.name} of the corpus"))
            continue
        path = folder / f"{name}.wrl"
        path.write_text(generated(name, 0.35 if quick else 1.0))
        out.append(Object(name, path, "generated"))
    return out
