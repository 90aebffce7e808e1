#!/usr/bin/env python3
"""Manual pages and completions know every option of every program: pages_test.py PAGES PROGRAM..."""

import gzip
import pathlib
import re
import subprocess
import sys
import unittest

pages, programs = pathlib.Path(sys.argv[1]), sys.argv[2:]

# Prints, for each line "PROGRAM COMMAND WORD" of its input, what bash completes WORD to.
COMPLETE = """
compopt() { :; }
for file in "$1"/bash/*; do source "$file"; done
while read -r program command word; do
  COMP_WORDS=("$program" "$command" "$word")
  [ "$command" != . ] || COMP_WORDS=("$program" "$word")
  COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
  "_${program//-/_}"
  echo "${COMPREPLY[*]}"
done
"""


def printed(words: list[str]) -> str:
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout


def questions() -> dict[tuple[str, str], str]:
    """The help of each program and command; of a program itself the command is "."."""
    result = {}
    for program in programs:
        name = pathlib.Path(program).name
        text = result[name, "."] = printed([program, "--help"])
        commands = re.findall(r"^  ([a-z]+)  ", text.partition("\nSubcommands:\n")[2], re.MULTILINE)
        for command in commands:
            if command != "help":
                result[name, command] = printed([program, command, "--help"])
    return result


def options_of(text: str) -> set[str]:
    """Written otherwise than packaging/ reads it."""
    explained = re.split(r"^Options:$", text, flags=re.MULTILINE)[1].split("\n\n")[0]
    return set(re.findall(r"^  (?:-\w,)?(--[a-z0-9-]+)", explained, re.MULTILINE))


class PagesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.asked = questions()

    def test_are_of_all_programs_and_commands(self) -> None:
        self.assertGreaterEqual(len(self.asked), 2)
        for name, command in self.asked:
            page = gzip.decompress((pages / "man1" / f"{name if command == '.' else f'{name}-{command}'}.1.gz")
                                   .read_bytes()).decode()
            shown = set(re.findall(r"\\fB(--[a-z0-9-]+)\\fR", page.replace("\\-", "-")))
            with self.subTest(f"{name} {command}"):
                self.assertTrue(shown)
                if (name, command) != ("verisq", "check") and (name, command) != ("verisq", "surface"):
                    self.assertEqual(shown, options_of(self.asked[name, command]))
                for line in page.splitlines():
                    self.assertRegex(line, r"^(\.(TH|SH|TP|PP|nf|fi)\b|[^.'])")

    def test_bash_completes_every_option(self) -> None:
        lines = "".join(f"{name} {command} --\n" for name, command in self.asked)
        done = subprocess.run(["bash", "-c", COMPLETE, "bash", str(pages)], input=lines, capture_output=True, text=True,
                              check=True)
        self.assertEqual(done.stderr, "")
        for (key, text), words in zip(self.asked.items(), done.stdout.splitlines(), strict=True):
            with self.subTest(" ".join(key)):
                self.assertEqual(set(words.split()), options_of(text))

    def test_bash_completes_commands(self) -> None:
        done = subprocess.run(["bash", "-c", COMPLETE, "bash", str(pages)], input="verisq . m\nverisq help ma\n",
                              capture_output=True, text=True, check=True)
        self.assertEqual(done.stdout, "map merge mesh\nmap\n")

    def test_zsh_knows_every_option(self) -> None:
        for name in {name for name, _ in self.asked}:
            text = (pages / "zsh" / f"_{name}").read_text()
            known = set(re.findall(r"^ +'\*(--[a-z0-9-]+)\[", text, re.MULTILINE))
            wanted: set[str] = set()
            for (program, command), help_text in self.asked.items():
                if program == name and (command != "." or name != "verisq"):
                    wanted |= options_of(help_text)
            self.assertEqual(known, wanted)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
