"""Completion of a program's command line by bash and zsh."""

from help_text import Entry, Help


def _long_names(options: list[Entry]) -> str:
    return " ".join(name for option in options for name in option.names if name.startswith("--"))


def _pattern(options: list[Entry]) -> str:
    names = [name for option in options for name in option.names]
    return "|".join(names) if names else "''"


def bash(program: Help, commands: list[Help]) -> str:
    """The function and what binds it to the program's name. `commands` are those of the program, if it has some."""
    name = program.words[0]
    function = "_" + name.replace("-", "_")
    everything = [program, *commands]
    with_file = [option for text in everything for option in text.options if option.is_file]
    with_value = [option for text in everything for option in text.options if option.value and not option.is_file]
    words = " ".join(text.words[-1] for text in commands)
    lines = [
        f"# Completion of {name} by bash: made of its help texts.",
        f"{function}() {{",
        '  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} words=""',
        "  COMPREPLY=()",
        "  case $before in",
        f"    {_pattern(with_file)}) compopt -o default 2>/dev/null; return ;;",
        f"    {_pattern(with_value)}) return ;;",
        "  esac",
    ]
    if commands:
        lines += [
            "  if [ \"$COMP_CWORD\" -eq 1 ] || { [ \"$COMP_CWORD\" -eq 2 ] && [ \"$before\" = help ]; }; then",
            f'    words="{words} {_long_names(program.options)}"',
            "    [ \"$before\" = help ] || words+=\" help\"",
            "  else",
            "    case ${COMP_WORDS[1]} in",
        ]
        for text in commands:
            lines.append(f'      {text.words[-1]}) words="{_long_names(text.options)}" ;;')
        lines += ["    esac", "  fi"]
    else:
        lines.append(f'  words="{_long_names(program.options)}"')
    lines += [
        '  if [[ $current != -* ]] && [ "$COMP_CWORD" -gt 1 ] && [ "$before" != help ]; then',
        "    compopt -o default 2>/dev/null",
        "    return",
        "  fi",
        '  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")',
        "}",
        f"complete -F {function} {name}",
    ]
    return "\n".join(lines) + "\n"


def _zsh_quoted(text: str) -> str:
    for special in "\\[]:":
        text = text.replace(special, "\\" + special)
    return text.replace("'", "'\\''")


def _zsh_option(option: Entry) -> list[str]:
    value = ""
    if option.value:
        value = f":{_zsh_quoted(option.value)}:" + ("_files" if option.is_file else " ")
    text = _zsh_quoted(option.text.split(". ")[0])
    return [f"'*{name}[{text}]{value}'" for name in option.names if name.startswith("-")]


def _zsh_arguments(options: list[Entry], indent: str) -> list[str]:
    specifications = [line for option in options for line in _zsh_option(option)] + ["'*:file:_files'"]
    return [f"{indent}_arguments \\"] + [f"{indent}  {line} \\" for line in specifications[:-1]] + [
        f"{indent}  {specifications[-1]}"]


def zsh(program: Help, commands: list[Help]) -> str:
    """The file that zsh loads for the program."""
    name = program.words[0]
    lines = [f"#compdef {name}", f"# Completion of {name} by zsh: made of its help texts."]
    if not commands:
        return "\n".join(lines + _zsh_arguments(program.options, "")) + "\n"
    lines += ["local -a commands", "commands=("]
    lines += [f"  '{command.names[0]}:{_zsh_quoted(command.text)}'" for command in program.commands]
    lines += [")", "if (( CURRENT == 2 )) || [[ $words[2] == help ]]; then", "  _describe command commands",
              "  return", "fi", "local command=$words[2]", "shift words", "(( CURRENT-- ))", "case $command in"]
    for text in commands:
        lines += [f"  {text.words[-1]})"] + _zsh_arguments(text.options, "    ") + ["    ;;"]
    return "\n".join(lines + ["esac"]) + "\n"
