"""``python -m releasing.dialects``: the PLC's block in two vendors' dialects, from one source.

``deploy/plc/AFF_GATEWAY.st`` is the source. Only spelling changes: names and types of variables,
literals, conversions, and what stands around the body. No compiler of these vendors has seen the
results; the tests read them back and run the cases of the source on them.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import escape

SOURCE = Path(__file__).parents[1] / "deploy" / "plc" / "AFF_GATEWAY.st"
UNTESTED = (
    "Made by `make plc` from AFF_GATEWAY.st, do not edit. UNTESTED: no compiler of this vendor\n"
    "   has seen it. Import it into a controller without a drive first, and sign COMMISSIONING.md."
)
_SECTION = re.compile(r"^(VAR\w*)\n(.*?)^END_VAR\n", re.MULTILINE | re.DOTALL)
_ROW = re.compile(r"^ +(\w+) : (\w+)(?: := ([^;]+))?; *(?:\(\* (.*?) \*\))?$", re.MULTILINE)
_TOKEN = re.compile(r"\(\*.*?\*\)|16#\w+|\w+|\W", re.DOTALL)


@dataclass(frozen=True, slots=True, kw_only=True)
class Variable:
    """One declared variable: ``initial`` as the source spells it, empty for the type's own."""

    section: str
    name: str
    type: str
    initial: str
    comment: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """A function block, taken apart: the comment at its head, its variables, its statements."""

    name: str
    head: str
    variables: tuple[Variable, ...]
    body: str


def read_block(text: str) -> Block:
    """Return the one function block of a source text.

    Raises
    ------
    ValueError
        The text is no function block, or declares something in a form that is not read here.
    """
    found = re.search(r"^FUNCTION_BLOCK (\w+)\n(.*)^END_FUNCTION_BLOCK", text, re.M | re.S)
    if found is None:
        raise ValueError("no FUNCTION_BLOCK in this text: give deploy/plc/AFF_GATEWAY.st")
    declared = []
    for section, rows in _SECTION.findall(found[2]):
        read = _ROW.findall(rows)
        if len(read) != len([row for row in rows.splitlines() if row.strip()]):
            raise ValueError(f"a line of {section} is no `Name : TYPE := value; (* text *)`")
        declared += [
            Variable(section=section, name=name, type=kind, initial=initial, comment=comment)
            for name, kind, initial, comment in read
        ]
    return Block(
        name=found[1],
        head=text[: found.start()].strip().removeprefix("(*").removesuffix("*)").strip(),
        variables=tuple(declared),
        body=found[2].rpartition("END_VAR\n")[2].strip() + "\n",
    )


def _spelt(body: str, spell: Callable[[str], str]) -> str:
    """Return the body with every token but comments spelt anew."""
    return "".join(
        token if token.startswith("(*") else spell(token) for token in _TOKEN.findall(body)
    )


def to_scl(block: Block) -> str:
    """Return the block as an external source of a Siemens S7-1200/1500 (SCL)."""
    types = {"BOOL": "Bool", "REAL": "Real", "INT": "Int", "UINT": "UInt", "WORD": "Word"}
    rows = [f"(* {UNTESTED}", "", f"   {block.head} *)", f'FUNCTION_BLOCK "{block.name}"']
    rows += ["{ S7_Optimized_Access := 'TRUE' }", "VERSION : 0.1"]
    for section in dict.fromkeys(item.section for item in block.variables):
        rows.append(f"   {section}")
        for item in (one for one in block.variables if one.section == section):
            initial = f" := {item.initial}" if item.initial else ""
            comment = f"   // {item.comment}" if item.comment else ""
            rows.append(f"      {item.name} : {types[item.type]}{initial};{comment}")
        rows.append("   END_VAR")
    names = {item.name for item in block.variables}
    body = _spelt(block.body, lambda token: f"#{token}" if token in names else token)
    return "\n".join([*rows, "BEGIN", body + "END_FUNCTION_BLOCK", ""])


_LOGIX_TYPES = {"BOOL": "BOOL", "REAL": "REAL", "INT": "INT", "UINT": "DINT", "WORD": "DINT"}
_LOGIX_USAGE = {"VAR_INPUT": "Input", "VAR_OUTPUT": "Output"}


def to_logix(block: Block) -> str:
    """Return the block as an add-on instruction of a Rockwell Logix controller (L5X).

    Logix has no UINT and no WORD: they are DINT of 0 to 65535, so the caller masks what comes off
    the wire with 16#FFFF. Its tags keep their values over a restart, and while the rung that it
    stands on is false its logic is not run: a routine for each, prescan and EnableInFalse, sets
    all that the block writes to what the source begins with.
    """
    written = [item for item in block.variables if item.section != "VAR_INPUT"]
    return _L5X.format(
        name=block.name,
        description=escape(f"{UNTESTED}\n\n{block.head}"),
        parameters="\n".join(_tag(item) for item in block.variables if item.section != "VAR"),
        local="\n".join(_tag(item) for item in block.variables if item.section == "VAR"),
        logic=_lines(_logix_body(block.body)),
        begin=_lines("".join(f"{item.name} := {_logix_value(item)};\n" for item in written)),
    )


def _tag(item: Variable) -> str:
    """Return a parameter, or a local tag, with what it begins with."""
    read_only = item.section != "VAR_INPUT"
    words = {"Name": item.name, "DataType": _LOGIX_TYPES[item.type]}
    words |= {"Radix": "Float" if item.type == "REAL" else "Decimal"}
    if item.section in _LOGIX_USAGE:
        words |= {"TagType": "Base", "Usage": _LOGIX_USAGE[item.section], "Visible": "true"}
        words |= {"Required": "false" if read_only or item.initial else "true"}
    words |= {"ExternalAccess": "Read Only" if read_only else "Read/Write"}
    kind = "Parameter" if item.section in _LOGIX_USAGE else "LocalTag"
    about = f"<Description><![CDATA[{item.comment}]]></Description>" if item.comment else ""
    data = f'<DefaultData Format="L5K"><![CDATA[{_logix_value(item)}]]></DefaultData>'
    given = " ".join(f'{name}="{word}"' for name, word in words.items())
    return f"<{kind} {given}>{about}{data}</{kind}>"


def _logix_value(item: Variable) -> str:
    zero = "0.0" if item.type == "REAL" else "0"
    return {"TRUE": "1", "FALSE": "0"}.get(item.initial, item.initial) or zero


def _logix_body(body: str) -> str:
    """Return the statements with Logix's literals and without conversions: it has none."""
    plain = re.sub(r"INT_TO_WORD\((\w+)\)", r"(\1 AND 16#FFFF)", body)
    plain = re.sub(r"(?:INT_TO_REAL|REAL_TO_INT)\((\w+)\)", r"\1", plain)
    literals: Mapping[str, str] = {"TRUE": "1", "FALSE": "0"}
    return _spelt(plain, lambda token: literals.get(token, token))


def _lines(text: str) -> str:
    return "\n".join(
        f'<Line Number="{at}"><![CDATA[{line}]]></Line>'
        for at, line in enumerate(text.splitlines())
    )


_L5X = """<?xml version="1.0" encoding="UTF-8" standalone="yes"?>
<RSLogix5000Content SchemaRevision="1.0" TargetName="{name}" \
TargetType="AddOnInstructionDefinition" ContainsContext="true">
<Controller Use="Context" Name="AFF">
<AddOnInstructionDefinitions Use="Context">
<AddOnInstructionDefinition Use="Target" Name="{name}" Revision="1.0" \
ExecutePrescan="true" ExecutePostscan="false" ExecuteEnableInFalse="true">
<Description>{description}</Description>
<Parameters>
<Parameter Name="EnableIn" TagType="Base" DataType="BOOL" Usage="Input" Radix="Decimal" \
Required="false" Visible="false" ExternalAccess="Read Only"/>
<Parameter Name="EnableOut" TagType="Base" DataType="BOOL" Usage="Output" Radix="Decimal" \
Required="false" Visible="false" ExternalAccess="Read Only"/>
{parameters}
</Parameters>
<LocalTags>
{local}
</LocalTags>
<Routines>
<Routine Name="Logic" Type="ST">
<STContent>
{logic}
</STContent>
</Routine>
<Routine Name="Prescan" Type="ST">
<STContent>
{begin}
</STContent>
</Routine>
<Routine Name="EnableInFalse" Type="ST">
<STContent>
{begin}
</STContent>
</Routine>
</Routines>
</AddOnInstructionDefinition>
</AddOnInstructionDefinitions>
</Controller>
</RSLogix5000Content>
"""

DIALECTS: Mapping[str, Callable[[Block], str]] = {".scl": to_scl, ".L5X": to_logix}


def main() -> int:
    """Write every dialect beside the source."""
    block = read_block(SOURCE.read_text(encoding="utf-8"))
    for suffix, write in DIALECTS.items():
        made = SOURCE.with_suffix(suffix)
        made.write_text(write(block), encoding="utf-8")
        print(f"{made}: untested, made from {SOURCE.name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
