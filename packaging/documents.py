#!/usr/bin/env python3
"""Writes manual pages and completions of the programs into a folder: documents.py FOLDER VERSION PROGRAM...

PROGRAM are paths of verisq, verisq-check, verisq-surface, whichever are built. Made of what the programs print for
--help, so that pages and completions cannot fall behind them.
"""

import gzip
import pathlib
import shutil
import sys

import completion
import help_text
import manual_page


def write_compressed(path: pathlib.Path, text: str) -> None:
    """The same bytes for the same text, whenever and wherever."""
    path.write_bytes(gzip.compress(text.encode(), compresslevel=9, mtime=0))


def commands_of(program: str, overall: help_text.Help) -> list[help_text.Help]:
    names = [command.names[0] for command in overall.commands if command.names[0] != "help"]
    return [help_text.ask(program, overall.words[0], name) for name in names]


def main(folder: pathlib.Path, version: str, programs: list[str]) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    for part in ("man1", "bash", "zsh"):
        (folder / part).mkdir(parents=True)
    alone = {pathlib.Path(program).name for program in programs}
    pages: dict[str, help_text.Help] = {}
    for program in sorted(programs, reverse=True):  # the page of a program that is one command is its own
        overall = help_text.ask(program, pathlib.Path(program).name)
        commands = commands_of(program, overall) if overall.commands else []
        name = overall.words[0]
        (folder / "bash" / name).write_text(completion.bash(overall, commands))
        (folder / "zsh" / f"_{name}").write_text(completion.zsh(overall, commands))
        pages.update({"-".join(text.words): text for text in [overall, *commands] if "-".join(text.words) not in pages})
    for name, text in pages.items():
        others = [page for page in sorted(pages) if page != name and (name in alone or page in alone)]
        write_compressed(folder / "man1" / f"{name}.1.gz", manual_page.manual_page(text, version, others))


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3:])
