"""Which places of a source may be wrong, and what stands there then: the rules of tests/mutants."""
import re

# What is no code: comments, texts, characters, preprocessor lines, assertions. Their places are blanked. So are sizes that
# are only reserved, which change no answer.
NO_CODE = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])+\'|^[ ]*#[^\n]*', re.S | re.M
)
UNSEEN_CALL = re.compile(r"\b(?:(?:static_)?assert|reserve)\s*\(")


def closing(text, at):
    """The place of the bracket that closes the one at `at`."""
    depth = 0
    for i in range(at, len(text)):
        depth += text[i] in "([{"
        depth -= text[i] in ")]}"
        if depth == 0:
            return i
    return len(text)


def code_of(text):
    """The text with all that is no code as spaces, in the same places."""
    blank = lambda m: re.sub(r"[^\n]", " ", m.group())
    code = NO_CODE.sub(blank, text)
    for m in reversed(list(UNSEEN_CALL.finditer(code))):
        end = closing(code, m.end() - 1) + 1
        code = code[: m.start()] + re.sub(r"[^\n]", " ", code[m.start() : end]) + code[end:]
    return code


ENDS_OPERAND = re.compile(r"&&|\|\||[;,?{}]|(?<!:):(?!:)|(?<![=!<>+*/|&-])=(?!=)|\breturn\b")


def operand(code, begin, end):
    """Cuts an operand of && or || out of code[begin:end], from the side that the operator is on."""
    forward = code[begin - 1 : begin] == " " and code[begin - 3 : begin - 1] in ("&&", "||")
    limits = {m.start(): m.end() for m in ENDS_OPERAND.finditer(code, begin, end)}
    order = range(begin, end) if forward else range(end - 1, begin - 1, -1)
    opens, closes = ("([{", ")]}") if forward else (")]}", "([{")
    starts = limits if forward else {last - 1: first for first, last in limits.items()}
    depth = 0
    for i in order:
        if depth == 0 and (code[i] in closes or i in starts):
            return (begin, i) if forward else (i + 1, end)
        depth += (code[i] in opens) - (code[i] in closes)
    return begin, end


def places(code):
    """All (begin, end, replacement, rule) in which one place of the code may be wrong."""
    # The words have a space on both sides: the brackets of templates have none.
    swaps = [
        ("comparison", {" < ": " <= ", " <= ": " < ", " > ": " >= ", " >= ": " > ", " == ": " != ", " != ": " == "}),
        ("bound", {" + 1": "", " - 1": "", "std::min(": "std::max(", "std::max(": "std::min(", " += 1": " += 0"}),
        ("sign", {" + ": " - ", " - ": " + ", " += ": " -= ", " -= ": " += "}),
    ]
    for rule, words in swaps:
        for word, other in words.items():
            for m in re.finditer(re.escape(word) + (r"(?![\w.])" if word[-1].isdigit() else ""), code):
                yield m.start(), m.end(), other, rule
    for m in re.finditer(r"(?<=[(,=?:] )-(?=[\w(])|(?<=\()-(?=[\w(])|(?<=return )-(?=[\w(])", code):
        yield m.start(), m.end(), "", "sign"
    for m in re.finditer(r"\bif \(", code):
        end = closing(code, m.end() - 1)
        condition = code[m.end() : end]
        if ";" in condition or re.match(r"\s*(const\b|auto\b)", condition):
            continue  # it declares something
        yield m.end(), end, f"true || ({condition})", "condition"
        yield m.end(), end, f"false && ({condition})", "condition"
    for m in re.finditer(r" (&&|\|\|) ", code):
        unit = "true" if m.group(1) == "&&" else "false"
        before, after = max(0, m.start() - 2000), min(len(code), m.end() + 2000)
        for begin, end in (operand(code, before, m.start()), operand(code, m.end(), after)):
            while begin < end and code[begin].isspace():
                begin += 1
            while begin < end and code[end - 1].isspace():
                end -= 1
            if begin < end:
                yield begin, end, unit, "condition"
