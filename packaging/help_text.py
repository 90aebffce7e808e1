"""What the programs say of themselves, taken apart: their --help is the one place where options are explained."""

import dataclasses
import re
import subprocess

_TEXT_COLUMN = 30  # where CLI11 puts explanations
_HEAD = re.compile(r"^(?:-\w,)?--?[\w-]+(?: \S+)?(?: REQUIRED)?$|^[\w-]+(?: \S+)?(?: REQUIRED)?$")


@dataclasses.dataclass
class Entry:
    """An option, or a command of the program."""

    names: list[str]
    value: str  # "" where it takes none
    required: bool
    text: str

    @property
    def is_file(self) -> bool:
        return "FILE" in self.value


@dataclasses.dataclass
class Help:
    """Of a program or of one of its commands."""

    words: list[str]  # as they are typed: ["verisq", "map"]
    description: str
    usage: str
    options: list[Entry]
    commands: list[Entry]
    closing_paragraphs: list[list[str]]


def _entry(head: str, text: str) -> Entry:
    words = head.split(" ")
    required = words[-1] == "REQUIRED"
    if required:
        words.pop()
    return Entry(words[0].split(","), " ".join(words[1:]), required, text)


def _entries(lines: list[str]) -> list[Entry]:
    entries: list[Entry] = []
    for line in lines:
        if line.startswith(" " * _TEXT_COLUMN):
            entries[-1].text = (entries[-1].text + " " + line.strip()).strip()
            continue
        head = line[:_TEXT_COLUMN].strip()
        beside = len(line) > _TEXT_COLUMN and line[_TEXT_COLUMN - 1] == " " and _HEAD.match(head)
        entries.append(_entry(head, line[_TEXT_COLUMN:].strip()) if beside else _entry(line.strip(), ""))
    return entries


def parse(words: list[str], text: str) -> Help:
    """The text of `words` --help. Raises ValueError for what CLI11 does not print."""
    head, usage, rest = re.split(r"^(Usage: .*)$", text, maxsplit=1, flags=re.MULTILINE)
    result = Help(words, " ".join(head.split()), usage.removeprefix("Usage: "), [], [], [])
    for block in re.split(r"\n\n+", rest.strip("\n")):
        lines = block.split("\n")
        if lines[0] in ("Options:", "Positionals:"):
            result.options += _entries(lines[1:])
        elif lines[0] == "Subcommands:":
            result.commands += _entries(lines[1:])
        else:
            result.closing_paragraphs.append(lines)
    if not result.options:
        raise ValueError(f"{' '.join(words)} --help explains no option")
    return result


def ask(program: str, name: str, command: str = "") -> Help:
    """What the program at the path `program`, called `name`, prints; of a command, if one is given."""
    words = [word for word in [command, "--help"] if word]
    done = subprocess.run([program, *words], capture_output=True, text=True, check=True)
    return parse([word for word in [name, command] if word], done.stdout)
