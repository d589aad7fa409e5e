"""scripts/thesis --quick makes the whole page: thesis_page_test.py REPOSITORY PEERD."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml

PEERD = pathlib.Path(sys.argv.pop())
REPOSITORY = pathlib.Path(sys.argv.pop())
SECTIONS = ["Table 3.1", "Figures 3.1 and 3.2", "Table 3.2", "Table 3.3", "Figure 3.8", "Table 3.4", "Figure 3.11", "Figure 4.4", "Table 4.1",
            "Figure 4.6", "Section 4.4.4", "Figures A.1 to A.4", "Figures A.5 to A.8", "Figures A.9 to A.12"]
OBJECTS = ["Al", "Galleon", "3000gt", "Mustang", "Eagle", "Tree", "Piping", "Truck"]


class ThesisPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        environment = {k: v for k, v in os.environ.items() if k != "PEERD_CORPUS"}
        done = subprocess.run([REPOSITORY / "scripts/thesis", "--quick", "--out", cls.folder.name, "--program", PEERD], capture_output=True, text=True,
                              check=False, env=environment)
        if done.returncode != 0:
            raise AssertionError(done.stdout + done.stderr)
        cls.text = pathlib.Path(cls.folder.name, "index.html").read_text()
        pieces = re.split(r'<h3 id="[^"]*">([^<]*)</h3>', cls.text)
        cls.sections = dict(zip(pieces[1::2], pieces[2::2]))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_has_all_tables_and_figures_in_order(self):
        self.assertEqual(list(self.sections), SECTIONS)
        for name, text in self.sections.items():
            self.assertRegex(text, r'<ul class="deviations"><li>', name)
            if name.startswith(("Table", "Section")):
                self.assertIn("<table>", text, name)
            if name.startswith("Figure"):
                self.assertIn("<svg", text, name)

    def test_has_a_picture_of_each(self):
        pictures = {name: re.findall(r'aria-label="([^"]*)"', text) for name, text in self.sections.items()}
        self.assertEqual(pictures["Figures 3.1 and 3.2"], OBJECTS)
        self.assertEqual(pictures["Figure 3.8"], OBJECTS)
        self.assertEqual(pictures["Figure 4.4"], ["sharp turn", "smooth motion"])
        appendix = [p.partition(":")[0] for name in SECTIONS[-3:] for p in pictures[name]]
        self.assertEqual(appendix, [f"Figure A.{n}" for n in range(1, 13)])

    def test_pictures_are_well_formed_and_drawn(self):
        pictures = re.findall(r"<svg.*?</svg>", self.text, re.S)
        self.assertGreaterEqual(len(pictures), 33)
        for picture in pictures:
            drawn = xml.fromstring(picture)
            self.assertTrue(any(child.tag in ("polyline", "circle", "rect") for child in drawn), drawn.get("aria-label"))
        self.assertNotRegex(self.text, r"\b(nan|inf)\b")

    def test_printed_numbers_stand_beside_ours(self):
        self.assertIn('<td class="p">221.99</td>', self.sections["Table 3.1"])
        self.assertIn('<td class="p">99</td>', self.sections["Table 3.2"])
        self.assertIn('<td class="p">1141.98</td>', self.sections["Table 3.3"])
        self.assertIn('<td class="p">0.5139</td>', self.sections["Table 3.4"])

    def test_what_must_hold_holds(self):
        self.assertIn("All hierarchies and our own engine say the same", self.sections["Table 3.4"])
        self.assertIn("All six kinds of pairs are treated as the thesis says", self.sections["Table 4.1"])
        self.assertIn("All peers have one outcome", self.sections["Section 4.4.4"])
        self.assertNotRegex(self.sections["Table 3.4"], r" there are 0 contacts")

    def test_needs_nothing_from_elsewhere(self):
        self.assertNotRegex(self.text, r"<script|https?://(?!www\.w3\.org)|src=")
        self.assertIn('name="viewport"', self.text)


if __name__ == "__main__":
    unittest.main()
