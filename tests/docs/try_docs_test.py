"""scripts/try-docs finds what a page shows wrongly, and nothing in a page that is right: try_docs_test.py REPOSITORY."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(sys.argv.pop(1)) / "scripts/try-docs"


class TryDocs(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()

    def tearDown(self):
        self.folder.cleanup()

    def try_page(self, text, *options, name="page.md"):
        page = pathlib.Path(self.folder.name, name)
        page.write_text(text)
        return subprocess.run([sys.executable, SCRIPT, *options, page], capture_output=True, text=True, check=False)

    def assert_good(self, text, *options):
        done = self.try_page(text, *options)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def assert_wrong(self, text, line, sentence):
        done = self.try_page(text)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn(f"page.md:{line}: ", done.stdout)
        self.assertIn(sentence, done.stdout)

    def assert_bad_page(self, text, sentence):
        done = self.try_page(text)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertIn(sentence, done.stderr)

    def test_what_is_shown_is_compared(self):
        self.assert_good("```console\n$ echo hello; echo you\nhello\nyou\n```\n")
        self.assert_wrong("# A page\n```console\n$ echo hello; echo you\nhello\nme\n```\n", 5, "this line is shown, and not printed there: me")
        self.assert_wrong("```console\n$ echo hello; echo you\nhello\n```\n", 3, "more is printed than shown")
        self.assert_wrong("```console\n$ echo hello\n```\n", 2, "more is printed than shown")
        self.assert_wrong("```console\n$ true\nhello\n```\n", 3, "this line is shown")
        self.assert_wrong("```console\n$ echo 1.5\n1.25\n```\n", 3, "this line is shown")

    def test_the_exit_code_is_compared(self):
        self.assert_wrong("```console\n$ false\n```\n", 2, "ends with 1, not with 0")
        self.assert_wrong("```console\n$ false\n$ true\n```\n", 2, "ends with 1, not with 0")
        self.assert_good("<!-- exit: 1 -->\n```console\n$ true\n$ false\n```\n")
        self.assert_wrong("<!-- exit: 1 -->\n```console\n$ true\n```\n", 3, "ends with 0, not with 1")
        self.assert_wrong("```console\n$ no-such-program 2>/dev/null\n```\n", 2, "ends with 127")

    def test_dots_stand_for_anything(self):
        self.assert_good("```console\n$ seq 5\n1\n...\n5\n$ echo between one and two\nbetween ... two\n```\n")
        self.assert_good("```console\n$ seq 2\n1\n...\n2\n```\n")
        self.assert_wrong("```console\n$ seq 5\n1\n...\n6\n```\n", 5, "this line is shown")
        self.assert_wrong("```console\n$ echo between one and two\nbetween ... three\n```\n", 3, "this line is shown")

    def test_numbers_may_differ_as_far_as_the_page_says(self):
        page = "<!-- numbers: {} -->\n```console\n$ echo 'x   10.5 of 100'\nx 10 of 110\n```\n"
        self.assert_good(page.format("any"))
        self.assert_good(page.format("10%"))
        self.assert_wrong(page.format("4%"), 4, "this line is shown")
        self.assert_wrong(page.format("any").replace("x 10", "y 10"), 4, "this line is shown")
        self.assert_wrong(page.format("any").replace("of 110", "of many"), 4, "this line is shown")
        self.assert_bad_page(page.format("some"), "neither \"any\" nor a percentage")

    def test_files_are_written_and_folders_last(self):
        self.assert_good("<!-- file: a/b.txt -->\n```\none\n```\n<!-- append: a/b.txt -->\n```text\ntwo\n```\n"
                         "```console\n$ ls\na\n$ cd a\n$ cat b.txt\none\ntwo\n```\n")

    def test_a_page_has_the_files_of_one_that_it_needs(self):
        pathlib.Path(self.folder.name, "first.md").write_text("<!-- file: one -->\n```\n1\n```\n```console\n$ touch never\n```\n")
        self.assert_good("<!-- page needs: first.md -->\n```console\n$ ls\none\n```\n")

    def test_a_command_stays_in_its_terminal(self):
        page = ("<!-- terminal: a; stays -->\n```console\n$ trap 'echo bye; exit 3' INT; echo up; until [ -e go ]; do sleep 0.05; done; echo went; sleep 30 & wait\n"
                "up\n```\n```console\n$ touch go\n```\n<!-- terminal: a -->\n```console\nwent\n```\n<!-- terminal: a; exit: 3 -->\n```console\n^C\nbye\n```\n")
        self.assert_good(page)
        self.assert_wrong(page.replace("^C\nbye", "^C\nhi"), 16, "this line is shown")
        self.assert_wrong(page.replace("; exit: 3", ""), 14, "ends with 3, not with 0")
        self.assert_wrong(page.replace("a -->\n```console\nwent", "a; limit: 1 -->\n```console\ncame"), 11, "this line is shown")
        # What is shown is printed only when the command is over.
        ends_first = "(while kill -0 $$ 2>/dev/null; do sleep 0.01; done; echo up) &"
        self.assert_wrong(f"<!-- terminal: a; stays -->\n```console\n$ {ends_first}\nup\n```\n", 3, "does not stay")
        self.assert_wrong("<!-- terminal: a; limit: 1 -->\n```console\n$ sleep 30\n```\n", 3, "still runs after 1 s")
        self.assert_wrong("```console\nwent\n```\n", 1, "no command runs")

    def test_words_are_copied(self):
        page = "```console\n$ echo pass:$((6 * 7))\npass:...\n$ echo got pass:...\ngot pass:42\n```\n"
        self.assert_good(page)
        self.assert_wrong(page.replace("echo got pass", "echo got word"), 4, "no word that begins with word:")

    def test_a_skip_is_said(self):
        page = "<!-- only if: false -->\n```console\n$ echo hello\nwrong\n```\n"
        self.assertIn("page.md:2: skipped, for this fails: false", self.assert_good(page))
        self.assertEqual(self.try_page(page, "--no-skips").returncode, 1)
        self.assert_wrong(page.replace("only if: false", "only if: true"), 4, "this line is shown")
        self.assertIn("skipped", self.assert_good("<!-- page only if: false -->\n" + page))

    def test_every_block_counts(self):
        self.assert_good("<!-- not run: a picture -->\n```\n(o)\n```\n")
        self.assert_bad_page("```\n(o)\n```\n", "page.md:1: the block is neither a console nor a file")
        self.assert_bad_page("```console\n$ true\n", "has no end")
        self.assert_bad_page("<!-- colour: red -->\n```console\n$ true\n```\n", "unknown attribute \"colour\"")
        self.assert_bad_page("<!-- terminal: a -->\nwords\n", "about no block")
        self.assert_bad_page("```console\nada$ true\nbo$ true\n```\n", "a block is of one computer")

    def test_nothing_of_the_user_is_seen(self):
        self.assert_good("```console\n$ ls -A; ls -A ~; echo \"[$XDG_CONFIG_HOME]\"\n[]\n```\n")

    def test_computers_reach_each_other(self):
        page = ("<!-- file: say.py -->\n```\nimport socket\ns = socket.create_server((\"\", 4000))\nprint(\"up\", flush=True)\nprint(s.accept()[1][0])\n```\n"
                "<!-- terminal: a; stays -->\n```console\nada$ python3 -u say.py\nup\n```\n"
                "```console\nbo$ python3 -c 'import socket; socket.create_connection((\"192.168.1.10\", 4000))'\n```\n"
                "<!-- terminal: a -->\n```console\n192.168.1.11\n```\n")
        said = self.assert_good(page)
        if "skipped" in said:
            self.skipTest(said)


if __name__ == "__main__":
    unittest.main()
