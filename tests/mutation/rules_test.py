"""Whether tests/mutants finds the wrong lines that its rules name, and writes many of them into one source."""
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from mutation.rules import code_of, places
from mutation.schema import named_in, together


def wrong(text):
    """All that the rules make of a text."""
    return sorted(text[:begin] + new + text[end:] for begin, end, new, _ in places(code_of(text)))


class Place:
    def __init__(self, number, begin, end, replacement, line=1, path="a.cpp"):
        self.number, self.begin, self.end, self.replacement = number, begin, end, replacement
        self.line = self.last_line = line
        self.path = path


def all_together(text):
    """The text with all of its wrong lines, numbered in the order of their places, and the numbers that fit."""
    mutants = [Place(n, *place[:3]) for n, place in enumerate(sorted(set(places(code_of(text)))), 1)]
    out, fitting = together(text, mutants, "wrong.hpp")
    return out.split("\n", 2)[2], [m.number for m in fitting]


class Rules(unittest.TestCase):
    def test_comparisons_bounds_and_signs(self):
        self.assertEqual(wrong("a < b;"), ["a <= b;"])
        self.assertEqual(wrong("a != b;"), ["a == b;"])
        self.assertEqual(wrong("n + 1;"), ["n - 1;", "n;"])
        self.assertEqual(wrong("n + 1.5;"), ["n - 1.5;"])
        self.assertEqual(wrong("n += 1;"), ["n += 0;", "n -= 1;"])
        self.assertEqual(wrong("std::min(a, b);"), ["std::max(a, b);"])
        self.assertEqual(wrong("return -a;"), ["return a;"])
        self.assertEqual(wrong("std::vector<int> v;"), [])

    def test_conditions(self):
        self.assertEqual(wrong("if (a) b();"), ["if (false && (a)) b();", "if (true || (a)) b();"])
        self.assertEqual(wrong("x = f(a, b) && c[i];"), ["x = f(a, b) && true;", "x = true && c[i];"])
        self.assertEqual(wrong("return a || !b;"), ["return a || false;", "return false || !b;"])
        self.assertEqual(wrong("if (const auto x = f()) g();"), [])

    def test_what_is_no_code(self):
        for text in ("// a < b", "/* a < b */", 's = "a < b";', "#if A < B", "assert(a < b);", "v.reserve(n + 1);", "f('<', ' < ');"):
            self.assertEqual(wrong(text), [], text)
        self.assertEqual(wrong("f(1'000, a < b, 2'000);"), ["f(1'000, a <= b, 2'000);"])


class Together(unittest.TestCase):
    def test_an_operator_stands_between_its_operands(self):
        self.assertEqual(all_together("a < b;"), ("a < wrong_1 < b;", [1]))
        self.assertEqual(all_together("a += b;"), ("a += wrong_1 = b;", [1]))
        self.assertEqual(all_together("return -a;"), ("return wrong_1->*a;", [1]))
        self.assertEqual(all_together("std::max(a, b);"), ("::wrong::most<1>(a, b);", [1]))

    def test_only_one_of_two_at_one_place(self):
        self.assertEqual(all_together("n + 1;")[1], [1])

    def test_conditions_enclose_what_is_wrong_within(self):
        text, fitting = all_together("if (a < b && c) d();")
        self.assertIn("a < wrong_", text)
        self.assertEqual(text.count("("), text.count(")"))
        self.assertEqual(text.count(".is() || (") + text.count(".is() && ("), len(fitting) - 1)

    def test_who_is_named_by_a_compiler(self):
        a, b = Place(1, 0, 1, "", 7), Place(2, 0, 1, "", 8)
        self.assertEqual(named_in("../../a.cpp:7:3: error: no\n/elsewhere/a.cpp:8:1: note", "/root", [a, b]), [a])
        self.assertEqual(named_in("/root/a.cpp:8:3:   required from here", "/root", [a, b]), [b])


if __name__ == "__main__":
    unittest.main()
