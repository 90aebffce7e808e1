#!/usr/bin/env python3
"""Makes the site of the documentation: docs_site.py BUILD, where the programs and the Python package are built

build/docs/pages holds README.md and docs/ as they are, the sources that they link to, and two pages made here: the
programs' help texts and Python's docstrings. mkdocs makes build/docs/site of them (mkdocs.yml). Fails for a link that
leads nowhere.
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

import help_text

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGES_FOLDER = ROOT / "build" / "docs" / "pages"
SITE = ROOT / "build" / "docs" / "site"
PAGES = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md"]
LINK = re.compile(r"\]\(([^)\s#]+)")


def linked_files(page: pathlib.Path) -> list[pathlib.Path]:
    """The files and folders of the repository that it links to, relative to the root."""
    found = []
    for target in LINK.findall(page.read_text()):
        if "://" not in target and not target.startswith("mailto:"):
            found.append((page.parent / target).resolve().relative_to(ROOT))
    return found


def copy(name: pathlib.Path) -> None:
    """A file, or a folder as a page that lists its files. Sources open in a browser as the text that they are."""
    source, target = ROOT / name, PAGES_FOLDER / name
    if source.is_dir():
        target.mkdir(parents=True, exist_ok=True)
        names = sorted(entry.name + "/" * entry.is_dir() for entry in source.iterdir())
        items = "".join(f"<li>{html.escape(entry)}</li>" for entry in names)
        (target / "index.html").write_text(f"<!doctype html><title>{name}</title><h1>{name}</h1><ul>{items}</ul>\n")
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(source, target)


def put_together() -> None:
    shutil.rmtree(PAGES_FOLDER, ignore_errors=True)
    open_pages = [pathlib.Path(name) for name in PAGES] + sorted(
        path.relative_to(ROOT) for path in (ROOT / "docs").iterdir()
    )
    done: set[pathlib.Path] = set()
    while open_pages:
        name = open_pages.pop()
        if name in done:
            continue
        done.add(name)
        copy(name)
        if name.suffix == ".md":
            open_pages += linked_files(ROOT / name)


def help_of(program: pathlib.Path, *command: str) -> str:
    shown = subprocess.run([program, *command, "--help"], capture_output=True, text=True, check=True).stdout
    return f"\n```text\n{shown}```\n"


def help_page(build: pathlib.Path) -> str:
    """The help texts of every program and command."""
    text = "# Help texts\n"
    for program in ("verisq", "verisq-check", "verisq-surface", "verisq-mpi"):
        if not (build / program).exists():
            continue
        text += f"\n## {program}\n" + help_of(build / program)
        for command in help_text.ask(str(build / program), program).commands:
            name = command.names[0]
            if name != "help":
                text += f"\n### {program} {name}\n" + help_of(build / program, name)
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


def broken_links() -> list[str]:
    """Those that lead to no file, or to no anchor of a page."""
    pages = {page: Links(page) for page in SITE.rglob("*.html") if page.name != "404.html"}
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
                broken.append(f"{page.relative_to(SITE)}: {target}")
    return broken


def main(build: pathlib.Path) -> None:
    put_together()
    (PAGES_FOLDER / "wide.css").write_text(".md-grid { max-width: 85rem; }\n")  # sources have 120 columns
    (PAGES_FOLDER / "reference").mkdir()
    (PAGES_FOLDER / "reference" / "help.md").write_text(help_page(build))
    (PAGES_FOLDER / "reference" / "python.md").write_text(python_page(build))
    subprocess.run(["mkdocs", "build", "--quiet", "--strict", "--clean"], cwd=ROOT, check=True)
    if broken := broken_links():
        sys.exit("links that lead nowhere:\n  " + "\n  ".join(broken))
    count = len(list(SITE.rglob("*.html")))
    print(f"site: {count} pages, all links lead somewhere; open {os.path.relpath(SITE / 'index.html')}")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]).resolve())
