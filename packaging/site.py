#!/usr/bin/env python3
"""Makes the site of the documentation: site.py ROOT BUILD OUT, with the programs and the Python package of BUILD

OUT/pages holds what mkdocs reads: README.md and docs/ as they are, the sources that they link to, and two pages made
here, of the programs' help texts and of Python's docstrings. OUT/site is the site. Fails for a link that leads nowhere.
"""

import html
import html.parser
import inspect
import os
import pathlib
import re
import shutil
import subprocess
import sys
import urllib.parse

PAGES = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md"]
LINK = re.compile(r"\]\(([^)\s#]+)")


def linked_files(page: pathlib.Path, root: pathlib.Path) -> list[pathlib.Path]:
    """What it links to in the repository: files and folders, relative to the root."""
    found = []
    for target in LINK.findall(page.read_text()):
        if "://" not in target and not target.startswith("mailto:"):
            found.append((page.parent / target).resolve().relative_to(root))
    return found


def copy(name: pathlib.Path, root: pathlib.Path, pages: pathlib.Path) -> None:
    """A file, or a folder as a page that lists its files. Sources open in a browser as the text that they are."""
    source, target = root / name, pages / name
    if source.is_dir():
        target.mkdir(parents=True, exist_ok=True)
        names = sorted(entry.name + "/" * entry.is_dir() for entry in source.iterdir())
        items = "".join(f"<li>{html.escape(entry)}</li>" for entry in names)
        (target / "index.html").write_text(f"<!doctype html><title>{name}</title><h1>{name}</h1><ul>{items}</ul>\n")
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(source, target)


def put_together(root: pathlib.Path, pages: pathlib.Path) -> None:
    shutil.rmtree(pages, ignore_errors=True)
    open_pages = [pathlib.Path(name) for name in PAGES] + sorted(
        path.relative_to(root) for path in (root / "docs").iterdir()
    )
    done: set[pathlib.Path] = set()
    while open_pages:
        name = open_pages.pop()
        if name in done:
            continue
        done.add(name)
        copy(name, root, pages)
        if name.suffix == ".md":
            open_pages += linked_files(root / name, root)


def help_page(build: pathlib.Path) -> str:
    """What every program and command prints for --help."""
    import help_text

    text = "# Help texts\n"
    for program in ("verisq", "verisq-check", "verisq-surface", "verisq-mpi"):
        if not (build / program).exists():
            continue
        ask = lambda *words: subprocess.run(
            [build / program, *words, "--help"], capture_output=True, text=True, check=True
        ).stdout
        text += f"\n## {program}\n\n```text\n{ask()}```\n"
        for command in help_text.ask(str(build / program), program).commands:
            name = command.names[0]
            if name != "help":
                text += f"\n### {program} {name}\n\n```text\n{ask(name)}```\n"
    return text


def docstring(thing: object, level: int, name: str) -> str:
    """A heading and the text. A docstring begins with its signature where the compiled part gives it one."""
    text = inspect.getdoc(thing) or ""
    return f"\n{'#' * level} {name}\n\n```text\n{text}\n```\n" if text else ""


def members(kind: type) -> list[tuple[str, object]]:
    return [(name, thing) for name, thing in sorted(vars(kind).items()) if not name.startswith("_")]


def python_page(build: pathlib.Path) -> str:
    """The docstrings of everything that the package names."""
    sys.path.insert(0, str(build / "python"))
    import verisq

    text = f"# Python, all classes\n\n```text\n{inspect.getdoc(verisq)}\n```\n"
    for name in verisq.__all__:
        thing = getattr(verisq, name)
        text += docstring(thing, 2, name) if not name.startswith("_") else ""
        if isinstance(thing, type) and thing.__module__.startswith("verisq"):
            for member, value in members(thing):
                text += docstring(value, 3, f"{name}.{member}")
    return text


class Links(html.parser.HTMLParser):
    """Where a page's links lead, and the anchors that it has."""

    def __init__(self, page: pathlib.Path) -> None:
        super().__init__()
        self.targets: list[str] = []
        self.anchors: set[str] = set()
        self.feed(page.read_text(errors="replace"))

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        for key, value in attributes:
            if key == "id" and value:
                self.anchors.add(value)
            if key in ("href", "src") and value:
                self.targets.append(value)


def broken_links(site: pathlib.Path) -> list[str]:
    """Those that lead to no file, or to no anchor of a page."""
    pages = {page: Links(page) for page in site.rglob("*.html") if page.name != "404.html"}
    broken = []
    for page, links in pages.items():
        for target in links.targets:
            parts = urllib.parse.urlsplit(target)
            if parts.scheme or parts.netloc:
                continue
            file = page if not parts.path else (page.parent / urllib.parse.unquote(parts.path)).resolve()
            if file.is_dir():
                file /= "index.html"
            has_anchor = not parts.fragment or file not in pages or parts.fragment in pages[file].anchors
            if not file.exists() or not has_anchor:
                broken.append(f"{page.relative_to(site)}: {target}")
    return broken


def main(root: pathlib.Path, build: pathlib.Path, out: pathlib.Path) -> None:
    pages = out / "pages"
    put_together(root, pages)
    (pages / "wide.css").write_text(".md-grid { max-width: 85rem; }\n")  # sources and docstrings have 120 columns
    (pages / "reference").mkdir()
    (pages / "reference" / "help.md").write_text(help_page(build))
    (pages / "reference" / "python.md").write_text(python_page(build))
    subprocess.run(["mkdocs", "build", "--quiet", "--strict", "--clean"], cwd=root, check=True)
    broken = broken_links(out / "site")
    if broken:
        sys.exit("links that lead nowhere:\n  " + "\n  ".join(broken))
    count = len(list((out / "site").rglob("*.html")))
    print(f"site: {count} pages, all links lead somewhere; open {os.path.relpath(out / 'site' / 'index.html')}")


if __name__ == "__main__":
    main(*(pathlib.Path(argument).resolve() for argument in sys.argv[1:4]))
