#!/usr/bin/env python3
"""manual_test.py PEERD SOURCE: has each command a manual page and completions, and are they well formed?

Writes them by scripts/manual, lints the pages by mandoc where it is, and asks bash itself what it would complete. zsh
and fish read theirs where they are installed."""
import pathlib
import shutil
import subprocess
import sys
import tempfile

peerd, source = sys.argv[1], pathlib.Path(sys.argv[2])
sys.dont_write_bytecode = True
sys.path.insert(0, str(source / "scripts"))
import cli_help  # noqa: E402

failures = []


def check(good, what):
    if not good:
        failures.append(what)


def completed_by_bash(file, words):
    """What bash offers for the last word."""
    listed = " ".join(f"'{word}'" for word in words)
    script = f"""source '{file}'; COMP_WORDS=({listed}); COMP_CWORD={len(words) - 1}; _peerd; printf '%s\\n' "${{COMPREPLY[@]}}" """
    done = subprocess.run(["bash", "--norc", "-c", script], capture_output=True, text=True)
    check(done.returncode == 0 and not done.stderr, f"bash completes {words} with an error: {done.stderr}")
    return set(done.stdout.split())


with tempfile.TemporaryDirectory() as scratch:
    folder = pathlib.Path(scratch)
    if shutil.which("scdoc") is None:
        print("skipped: there is no scdoc")
        sys.exit(77)
    subprocess.run([source / "scripts/manual", peerd, folder], check=True)
    top = cli_help.command(peerd)
    commands = list(cli_help.all_commands(top))
    check(len(commands) > 40, f"{len(commands)} commands were read")

    for command in [top, *top.commands]:
        name = "-".join(["peerd", *command.words])
        page = folder / "man" / f"{name}.1"
        if not page.exists():
            check(False, f"{command.name} has no page")
            continue
        text = page.read_text().replace("\\-", "-").replace("\\&", "")
        for each in cli_help.all_commands(command) if command.words else [command]:
            check(" ".join(each.words) in text, f"{page.name} does not name {each.name}")
            for option in each.options + each.positionals:
                check(option.says != "", f"{each.name} says nothing of {option.names}")
                if each is command or option.names != ["-h", "--help"]:
                    check(all(n in text for n in option.names), f"{page.name} does not name {option.names}")
        if shutil.which("mandoc"):
            lint = subprocess.run(["mandoc", "-Tlint", "-Werror", page], capture_output=True, text=True)
            check(lint.returncode == 0, f"mandoc: {lint.stdout}")

    bash = folder / "completions/peerd"
    for command in commands:
        options = {name for option in command.options for name in option.names}
        check(completed_by_bash(bash, ["peerd", *command.words, "-"]) == options, f"bash does not offer the options of {command.name}")
        if command.commands:
            names = {below.words[-1] for below in command.commands}
            check(completed_by_bash(bash, ["peerd", *command.words, ""]) == names, f"bash does not offer the commands of {command.name}")
    check(completed_by_bash(bash, ["peerd", "ctl", "--name", "key", "sta"]) == {"status"}, "bash takes an option's value for a command")
    for shell, file in (("zsh", "_peerd"), ("fish", "peerd.fish")):
        text = (folder / "completions" / file).read_text()
        for command in commands:
            for option in command.options:
                check(all(name.lstrip("-") in text for name in option.names), f"{file} does not name {option.names}")
        if shutil.which(shell):
            done = subprocess.run([shell, "-n", folder / "completions" / file], capture_output=True, text=True)
            check(done.returncode == 0, f"{shell} can't read {file}: {done.stderr}")

print("\n".join(failures))
print(f"{len(commands)} commands, {len(failures)} failures")
sys.exit(1 if failures else 0)
