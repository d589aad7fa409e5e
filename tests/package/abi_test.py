#!/usr/bin/env python3
"""abi_test.py LIBRARY SOURCE: the library has the interface that is committed, and scripts/abi finds what would break programs:
each of these changes is made in a copy of the header."""
import pathlib
import shutil
import subprocess
import sys
import tempfile

HEADER, LIST = "peerd/daemon/embed/include/peerd/peerd.h", "peerd/daemon/embed/abi/libpeerd-0.1.txt"
SYMBOLS = "debian/libpeerd0.1.symbols"

# What is changed (a file, a text, another one), and what a line of the findings says of it.
BREAKS = {
    "a member moves": ((HEADER, "uint32_t kind;\n  uint32_t peer;", "uint32_t peer;\n  uint32_t kind;"),
                       "break: member peerd_event.kind at 0 is unsigned int: now at 4"),
    "a member is gone": ((HEADER, "  int32_t reserved; /* 0 */\n", ""), "break: member peerd_motion.reserved"),
    "a member has another type": ((HEADER, "int32_t jumps;", "uint32_t jumps;"), "peerd_motion.jumps at 88 is int: now at 88 is unsigned int"),
    "a struct grows that programs make arrays of": ((HEADER, "int32_t reserved; /* 0 */", "int32_t reserved; double mass;"),
                                                    "break: member peerd_motion.mass at 96 is double: programs do not say"),
    "a new member stands before others": ((HEADER, "  const char* name;\n", "  double mass;\n  const char* name;\n"),
                                          "break: member peerd_event.mass at 272 is double: new members stand at the end"),
    "a constant has another value": ((HEADER, "PEERD_CONTACT = 3", "PEERD_CONTACT = 30"), "break: constant PEERD_CONTACT = 3: now = 30"),
    "a constant is gone": ((HEADER, "  PEERD_PEER_LEFT = 2,", "  PEERD_LEFT = 2,"), "break: constant PEERD_PEER_LEFT = 2: it is gone"),
    "a type is another one": ((HEADER, "typedef uint64_t peerd_object;", "typedef uint32_t peerd_object;"),
                              "break: type peerd_object is unsigned long, size 8: now is unsigned int, size 4"),
    "a parameter is another one": ((HEADER, "peerd_poll(peerd_peer* peer, double at_most_s)", "peerd_poll(peerd_peer* peer, float at_most_s)"),
                                   "break: function peerd_poll is int (peerd_peer*, double): now is int (peerd_peer*, float)"),
    "a function returns something else": ((HEADER, "PEERD_API int peerd_start(", "PEERD_API void peerd_start("), "break: function peerd_start"),
    "a function is gone": ((HEADER, "PEERD_API int peerd_in_session(peerd_peer* peer);\n", ""), "break: function peerd_in_session"),
    "a symbol is gone": ((HEADER, "PEERD_API int peerd_start(", "PEERD_API int peerd_vanished(peerd_peer* peer);\nPEERD_API int peerd_start("),
                         "peerd_vanished: declared in peerd.h, and no symbol"),
    "the version is another one": ((HEADER, "PEERD_API_MINOR 1", "PEERD_API_MINOR 2"), "soname libpeerd.so.0.1: the interface is 0.2"),
    "the package does not list it": ((SYMBOLS, " peerd_start@Base 0.2.0~\n", ""), "peerd_start is missing"),
}
# What may be added, and what scripts/abi says of that until it is in the list.
ADDITIONS = {
    "an event gets a member": ((HEADER, "  uint64_t count;\n}", "  uint64_t count;\n  double mass;\n}"), "new: member peerd_event.mass at 304"),
    "there is another event": ((HEADER, "PEERD_CONTACT_OVERRULED = 9", "PEERD_CONTACT_OVERRULED = 9, PEERD_WEATHER = 10"),
                               "new: constant PEERD_WEATHER = 10"),
    "there is another struct": ((HEADER, "typedef struct peerd_motion {", "typedef struct peerd_place { double x; } peerd_place;\ntypedef struct peerd_motion {"),
                                "new: member peerd_place.x"),
    "there is another function": ((LIST, "function peerd_undo is int (peerd_peer*, peerd_operation*)\n", ""), "new: function peerd_undo"),
}


def copy_of(source, folder, change):
    for name in (HEADER, LIST, SYMBOLS):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source / name, folder / name)
    if change:
        name, before, after = change
        text = (folder / name).read_text()
        if text.count(before) != 1:
            raise SystemExit(f"{name} has {before!r} {text.count(before)} times; this test needs another change")
        (folder / name).write_text(text.replace(before, after))


def main():
    library, source = (pathlib.Path(word).resolve() for word in sys.argv[1:])
    wrong = []

    def expect(what, change, code, said, renewed):
        """The exit codes of a check, and of --renew; the check says this."""
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(scratch)
            copy_of(source, folder, change)
            before = (folder / LIST).read_text()
            check, renew = (subprocess.run([source / "scripts/abi", library, "--source", folder, *more], capture_output=True, text=True)
                            for more in ([], ["--renew"]))
            if check.returncode != code or said not in check.stdout or "Traceback" in check.stderr:
                wrong.append(f"{what}: ended with {check.returncode} and said {check.stdout}{check.stderr}")
            if renew.returncode != renewed or (renewed and (folder / LIST).read_text() != before):
                wrong.append(f"{what}: --renew ended with {renew.returncode} and said {renew.stdout}{renew.stderr}")
            print(f"{what}: {check.stdout.splitlines()[0] if check.stdout else 'nothing is found'}")

    expect("as it is", None, 0, "", 0)
    for what, (change, said) in BREAKS.items():
        expect(what, change, 1, said, 1)
    for what, (change, said) in ADDITIONS.items():
        expect(what, change, 1, said, 0)
    if wrong:
        raise SystemExit("\n".join(wrong))


if __name__ == "__main__":
    main()
