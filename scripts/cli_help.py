"""What the program says of itself: its commands with their options, read from `--help`. For scripts/cli-reference and
scripts/manual."""
import dataclasses
import re
import subprocess


@dataclasses.dataclass
class Option:
    names: list  # ["-c", "--config"]; of a positional argument its one name
    value: str   # "TEXT", "UINT", "[ADDRESS:PORT]"; empty: it takes none
    says: str


@dataclasses.dataclass
class Command:
    words: list  # ["ctl", "key"]; none: the program itself
    text: str    # the whole help
    says: str    # its first line
    usage: str
    positionals: list
    options: list
    footer: str
    commands: list

    @property
    def name(self):
        return " ".join(["peerd", *self.words])


def help_of(peerd, words):
    done = subprocess.run([peerd, *words, "--help"], capture_output=True, text=True, check=True)
    return done.stdout.replace(str(peerd), "peerd").strip()


COLUMN = 30  # where what is said begins, on the row itself or on the next one


def rows(text, title):
    """The rows of a section of the help: what is named, and what is said of it."""
    found = re.search(rf"^{title}:\n((?:  .*\n?)*)", text + "\n", re.M)
    lines = found.group(1).splitlines() if found else []
    for line, following in zip(lines, [*lines[1:], ""]):
        if line.startswith(" " * COLUMN):
            continue
        if following.startswith(" " * COLUMN):
            yield line.strip(), following.strip()
        else:
            yield line[:COLUMN].strip(), line[COLUMN:].strip()


def option(named, says):
    words, _, relations = named.partition(" Excludes: ")
    relations, _, needs = relations.partition(" Needs: ")
    words, _, more_needs = words.partition(" Needs: ")
    names, _, value = re.sub(r"\{\w+\}", "", words).partition(" ")
    for title, others in (("not with", relations), ("only with", needs or more_needs)):
        if others:
            says += f" ({title} {', '.join(others.split())})"
    return Option(names.split(","), value, says)


def command(peerd, words=()):
    """A command with all below it."""
    words = list(words)
    text = help_of(peerd, words)
    said, usage = re.match(r"(.*)\nUsage: (.*)", text).groups()
    footer = re.search(r"\n\n((?:Exit codes|Ends by)[^\n]*(?:\n\S[^\n]*)*)$", text)
    below = [command(peerd, [*words, name]) for name, _ in rows(text, "Subcommands")]
    return Command(words, text, said, usage, [option(*row) for row in rows(text, "Positionals")],
                   [option(*row) for row in rows(text, "Options")], footer.group(1) if footer else "", below)


def all_commands(top):
    yield top
    for below in top.commands:
        yield from all_commands(below)
