"""Charts as SVG texts. Colours are CSS classes of the page, so that light and dark have their own."""
import html
import math


def number(x):
    if x == 0:
        return "0"
    if abs(x) >= 1e5 or abs(x) < 1e-3:
        return f"{x:.0e}".replace("e-0", "e-").replace("e+0", "e")
    return f"{x:.4g}".replace("-", "−")


def ticks(low, high, count):
    span = high - low
    if span <= 0:
        return [low]
    step = 10 ** math.floor(math.log10(span / count))
    step *= min((m for m in (1, 2, 5, 10) if span / (step * m) <= count), default=10)
    first = math.ceil(low / step - 1e-9)
    return [step * (first + i) for i in range(int((high - first * step) / step + 1e-9) + 1)]


def log_ticks(low, high):
    powers = [10.0 ** e for e in range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)]
    inside = [p for p in powers if low <= p * 1.0001 and p <= high * 1.0001]
    if len(inside) >= 2:
        return inside
    return [p * m for p in powers for m in (1, 2, 5) if low <= p * m * 1.0001 and p * m <= high * 1.0001]


class Series:
    """`style` is line, bars, marks or dots; `colour` numbers the page's colours from 0."""

    def __init__(self, name, points, colour=0, style="line"):
        self.name, self.colour, self.style = name, colour, style
        self.points = [(x, y) for x, y in points if math.isfinite(x) and math.isfinite(y)]


class Panel:
    def __init__(self, series, x, y, log_x=False, log_y=False, x_range=None, y_range=None, height=150):
        self.series, self.x, self.y, self.log_x, self.log_y, self.height = series, x, y, log_x, log_y, height
        self.x_range, self.y_range = x_range, y_range

    def bounds(self, index, log, given):
        values = [p[index] for s in self.series for p in s.points if not log or p[index] > 0]
        if given:
            return given
        if not values:
            return (1, 10) if log else (0, 1)
        low, high = min(values), max(values)
        if log:
            return (low / 1.1, high * 1.1)
        if index == 1:
            low = min(low, 0) if low < 0.5 * high or any(s.style == "bars" for s in self.series) else low
            room = 0.06 * (high - low or abs(high) or 1)
            return (low if low == 0 else low - room, high + room)
        return (low, high) if high > low else (low - 1, high + 1)


WIDTH, LEFT, RIGHT = 380, 52, 10


def chart(title, panels, legend=True):
    """One picture: a title, a legend of the first panel's series, and panels below each other."""
    names = []
    for panel in panels:
        for s in panel.series:
            if s.name and (s.name, s.colour, s.style) not in names:
                names.append((s.name, s.colour, s.style))
    out, y = [], 16
    out.append(f'<text x="2" y="{y}" class="t">{html.escape(title)}</text>')
    if legend and len(names) > 1:
        x, y = 4, y + 18
        for name, colour, style in names:
            width = 26 + 6.3 * len(name)
            if x + width > WIDTH:
                x, y = 4, y + 16
            mark = (f'<circle cx="{x + 8}" cy="{y - 4}" r="3" class="f{colour}"/>' if style in ("dots", "marks") else
                    f'<path d="M{x} {y - 4}h16" class="s{colour}"/>')
            out.append(mark + f'<text x="{x + 20}" y="{y}">{html.escape(name)}</text>')
            x += width + 6
    y += 8
    for panel in panels:
        out.append(draw(panel, y))
        y += panel.height + 44
    return (f'<svg viewBox="0 0 {WIDTH} {y}" role="img" aria-label="{html.escape(title)}">' + "".join(out) + "</svg>")


def draw(panel, top):
    top += 12
    left, right, bottom = LEFT, WIDTH - RIGHT, top + panel.height
    (x0, x1), (y0, y1) = panel.bounds(0, panel.log_x, panel.x_range), panel.bounds(1, panel.log_y, panel.y_range)

    def scale(value, low, high, begin, end, log):
        if log:
            value, low, high = math.log(max(value, low * 1e-3)), math.log(low), math.log(high)
        return begin + (end - begin) * (value - low) / (high - low)

    def at(p):
        return scale(p[0], x0, x1, left, right, panel.log_x), scale(p[1], y0, y1, bottom, top, panel.log_y)
    out = [f'<text x="{left}" y="{top - 4}" class="a">{html.escape(panel.y)}</text>']
    for t in log_ticks(y0, y1) if panel.log_y else ticks(y0, y1, max(2, panel.height // 32)):
        y = at((x0, t))[1]
        out.append(f'<path d="M{left} {y:.1f}H{right}" class="g"/>'
                   f'<text x="{left - 5}" y="{y + 4:.1f}" class="e">{number(t)}</text>')
    for t in log_ticks(x0, x1) if panel.log_x else ticks(x0, x1, 8):
        x = at((t, y0))[0]
        out.append(f'<path d="M{x:.1f} {bottom}v4" class="k"/><text x="{x:.1f}" y="{bottom + 16}" class="m">{number(t)}</text>')
    out.append(f'<path d="M{left} {top}V{bottom}H{right}" class="k"/>')
    out.append(f'<text x="{right}" y="{bottom + 29}" class="e a">{html.escape(panel.x)}</text>')
    for s in panel.series:
        where = [at(p) for p in s.points]
        if s.style == "bars":
            width = (at((x0 + 1, y0))[0] - left) * 0.86
            out += [f'<rect x="{x + 0.07 * width:.1f}" y="{y:.1f}" width="{width:.1f}" height="{max(0, bottom - y):.1f}" class="f{s.colour}"/>'
                    for x, y in where]
        elif s.style in ("dots", "marks"):
            out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{3 if s.style == "dots" else 1.6}" class="f{s.colour}"/>' for x, y in where]
        elif where:
            out.append('<polyline points="' + " ".join(f"{x:.1f},{y:.1f}" for x, y in thinned(where)) + f'" class="s{s.colour}"/>')
    return "".join(out)


def thinned(points):
    """Without points that a line of a third of a pixel passes anyway; first and last of each column's extremes stay."""
    if len(points) < 800:
        return points
    step = len(points) // 400
    out = []
    for i in range(0, len(points), step):
        part = points[i:i + step]
        keep = {part[0], min(part, key=lambda p: p[1]), max(part, key=lambda p: p[1]), part[-1]}
        out += [p for p in part if p in keep]
    return out
