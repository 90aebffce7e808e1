"""A help text as a page of the manual, in the language of groff's macros man (groff_man(7))."""

from help_text import Entry, Help


def _escaped(text: str) -> str:
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("^", "\\(ha").replace("~", "\\(ti")
    return "\\&" + text if text[:1] in (".", "'") else text


def _paragraph(lines: list[str]) -> list[str]:
    """Lines that are indented stay as they are; others are filled."""
    result: list[str] = [".PP"]
    as_it_is = False
    for line in lines:
        if line.startswith(" ") != as_it_is:
            as_it_is = not as_it_is
            result.append(".nf" if as_it_is else ".fi")
        result.append(_escaped(line))
    if as_it_is:
        result.append(".fi")
    return result


def _entry(entry: Entry) -> list[str]:
    names = ", ".join(f"\\fB{_escaped(name)}\\fR" for name in entry.names)
    value = f" \\fI{_escaped(entry.value)}\\fR" if entry.value else ""
    return [".TP", names + value, _escaped(entry.text + (" (required)" if entry.required else ""))]


def _closing(paragraphs: list[list[str]]) -> list[str]:
    result: list[str] = [".SH DESCRIPTION"] if paragraphs else []
    for lines in paragraphs:
        if lines[0].startswith("Exit status:"):
            result.append(".SH EXIT STATUS")
            lines = [lines[0].removeprefix("Exit status: ")] + lines[1:]
        elif lines[0] == "Examples:":
            result.append(".SH EXAMPLES")
            lines = lines[1:]
        result += _paragraph(lines)
    return result


def manual_page(help_text: Help, version: str, see_also: list[str]) -> str:
    """Section 1. `see_also` are names of other pages of that section."""
    title = "-".join(help_text.words)
    description = help_text.description.removeprefix(help_text.words[0] + ": ")
    purpose = description.split(". ")[0].rstrip(".")
    lines = [
        f'.TH {_escaped(title).upper()} 1 "" "verisq {version}" "verisq"',
        ".SH NAME",
        f"{_escaped(title)} \\- {_escaped(purpose[0].lower() + purpose[1:])}",
        ".SH SYNOPSIS",
        _escaped(help_text.usage),
    ]
    if help_text.commands:
        lines.append(".SH COMMANDS")
        for command in help_text.commands:
            lines += _entry(command)
    lines.append(".SH OPTIONS")
    for option in help_text.options:
        lines += _entry(option)
    lines += _closing(help_text.closing_paragraphs)
    if see_also:
        lines += [".SH SEE ALSO", ", ".join(f"\\fB{_escaped(page)}\\fR(1)" for page in see_also)]
    return "\n".join(lines) + "\n"
