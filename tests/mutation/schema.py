"""Many wrong lines in one build: sources in which each is there only for the program that is started with its number."""
import re

# How a place of each rule is written; `{n}` is its number. `insert` goes behind the place's text, `replace` instead of it,
# `around` before and behind it.
OPERATORS = (" < ", " <= ", " > ", " >= ", " == ", " != ", " + ", " - ")


def edits(text, begin, end, replacement, n):
    """The (begin, end, new text, length of what it encloses) that make this place wrong in program number n alone."""
    was = text[begin:end]
    if was in OPERATORS:
        return [(end, end, f"wrong_{n} {was.strip()} ", 0)]
    if was in (" += ", " -= "):
        return [(end, end, f"wrong_{n} = ", 0)]
    if was in (" + 1", " - 1", " += 1"):
        return [(end - 1, end, f"wrong_{n}.one()", 0)]
    if was in ("std::min(", "std::max("):
        return [(begin, end, f"::wrong::{'least' if 'min' in was else 'most'}<{n}>(", 0)]
    if was == "-":
        return [(begin, end, f"wrong_{n}->*", 0)]
    always = replacement.startswith("true")
    opening = f"(wrong_{n}.is() || (" if always else f"(!wrong_{n}.is() && ("
    return [(begin, begin, opening, end - begin), (end, end, "))", end - begin)]


def clash(placed, begin, end):
    """Whether a place overlaps another one without the one's enclosing the other."""
    return any(b < end and begin < e and not (b < begin and end < e) and not (begin < b and e < end) for b, e in placed)


def together(text, mutants, header):
    """The text with all mutants that fit beside each other, and those."""
    fitting, placed, all_edits = [], [], []
    for m in mutants:
        if clash(placed, m.begin, m.end):
            continue
        placed.append((m.begin, m.end))
        fitting.append(m)
        all_edits += edits(text, m.begin, m.end, m.replacement, m.number)

    # At one place, what ends there comes first, the innermost before the others, and then what begins, the outermost first.
    def order(edit):
        begin, end, new, length = edit
        closes = new == "))"
        return (begin, 0 if closes else 1, length if closes else -length)

    out, at = [f'#include "{header}"\n#line 1\n'], 0
    for begin, end, new, _ in sorted(all_edits, key=order):
        out += [text[at:begin], new]
        at = end
    return "".join(out) + text[at:], fitting


def header_of(numbers, wrong_hpp):
    """The header that names the wrong lines."""
    lines = "".join(f"inline constexpr wrong::At<{n}> wrong_{n}{{}};\n" for n in numbers)
    return f'#pragma once\n#include "{wrong_hpp}"\n{lines}'


PLACE = re.compile(r"([\w./-]+\.[ch]pp):(\d+)")


def named_in(output, root, mutants):
    """The mutants on whose lines a compiler found something wrong."""
    named = {}
    for m in PLACE.finditer(output):
        path = re.sub(r"^(\.\./)+", "", m.group(1).removeprefix(f"{root}/"))
        named.setdefault(path, set()).add(int(m.group(2)))
    return [m for m in mutants if any(m.line <= line <= m.last_line for line in named.get(str(m.path), ()))]
