"""``modelDescription.xml`` of both versions, and how the source is built."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal
from xml.etree import ElementTree as Xml

from sim_plant.export.interface import Interface
from sim_plant.export.units import UNITS
from sim_plant.export.variable import Variable

Version = Literal["2.0", "3.0"]
TOOL = "sim-plant export"
LICENCE = "Apache-2.0"
OPTIONS = ("-std=c99", "-O3", "-ffp-contract=off")
"""Of the compiler: contracted products would round once where the kernel rounds twice."""

_KINDS = {
    ("real", "3.0"): "Float64",
    ("integer", "3.0"): "Int32",
    ("truth", "3.0"): "Boolean",
    ("real", "2.0"): "Real",
    ("integer", "2.0"): "Integer",
    ("truth", "2.0"): "Boolean",
}
_CATEGORIES = {
    "logStatusError": "What was refused, and why",
    "logStatusWarning": "What was left undone, and why",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Model:
    """What a description says beside the variables.

    Attributes
    ----------
    identifier : C name of the model; source and binary are called after it.
    token : what tells this model from another one.
    """

    name: str
    identifier: str
    token: str
    text: str
    version: str
    sample_time_s: float


def description(model: Model, interface: Interface, version: Version) -> bytes:
    """Return ``modelDescription.xml``."""
    third = version == "3.0"
    root = Xml.Element(
        "fmiModelDescription",
        {
            "fmiVersion": version,
            "modelName": model.name,
            "instantiationToken" if third else "guid": model.token,
            "description": model.text,
            "version": model.version,
            "license": LICENCE,
            "generationTool": f"{TOOL} {model.version}",
            "variableNamingConvention": "structured",
        },
    )
    _co_simulation(root, model, version)
    _units(root, interface)
    categories = Xml.SubElement(root, "LogCategories")
    for name, text in _CATEGORIES.items():
        Xml.SubElement(categories, "Category", {"name": name, "description": text})
    experiment = {"startTime": "0", "stopTime": "20", "stepSize": repr(model.sample_time_s)}
    Xml.SubElement(root, "DefaultExperiment", experiment)
    variables = Xml.SubElement(root, "ModelVariables")
    for number, variable in enumerate(interface.variables):
        _variable(variables, number, variable, version)
    structure = Xml.SubElement(root, "ModelStructure")
    (_structure_3 if third else _structure_2)(structure, interface)
    return as_bytes(root)


def build_description(model: Model, source: str) -> bytes:
    """Return ``sources/buildDescription.xml`` of FMI 3.0."""
    root = Xml.Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    text = "C99 and its library of mathematics; without contraction of products"
    build = Xml.SubElement(
        root, "BuildConfiguration", {"modelIdentifier": model.identifier, "description": text}
    )
    files = Xml.SubElement(build, "SourceFileSet", {"language": "C99"})
    Xml.SubElement(files, "SourceFile", {"name": source})
    return as_bytes(root)


def as_bytes(root: Xml.Element) -> bytes:
    """Return an indented XML document."""
    Xml.indent(root)
    return bytes(Xml.tostring(root, encoding="UTF-8", xml_declaration=True)) + b"\n"


def _co_simulation(root: Xml.Element, model: Model, version: Version) -> None:
    found = {"modelIdentifier": model.identifier, "canHandleVariableCommunicationStepSize": "true"}
    if version == "3.0":
        found |= {"canGetAndSetFMUState": "true", "canSerializeFMUState": "true"}
        found |= {"fixedInternalStepSize": repr(model.sample_time_s)}
        Xml.SubElement(root, "CoSimulation", found)
        return
    found |= {"canGetAndSetFMUstate": "true", "canSerializeFMUstate": "true"}
    found |= {"canNotUseMemoryManagementFunctions": "true"}
    simulation = Xml.SubElement(root, "CoSimulation", found)
    files = Xml.SubElement(simulation, "SourceFiles")
    Xml.SubElement(files, "File", {"name": "fmi2.c"})


def _units(root: Xml.Element, interface: Interface) -> None:
    used = {variable.unit for variable in interface.variables}
    definitions = Xml.SubElement(root, "UnitDefinitions")
    for name, unit in UNITS.items():
        if name not in used:
            continue
        made = Xml.SubElement(definitions, "Unit", {"name": name})
        powers = {base: str(power) for base, power in unit.exponents.items()}
        Xml.SubElement(made, "BaseUnit", powers)
        if unit.shown is not None:
            shown, factor = unit.shown
            Xml.SubElement(made, "DisplayUnit", {"name": shown, "factor": repr(factor)})


def _variable(parent: Xml.Element, number: int, variable: Variable, version: Version) -> None:
    common = {
        "name": variable.name,
        "valueReference": str(number),
        "description": variable.description,
        "causality": variable.causality,
        "variability": variable.variability,
    }
    if variable.causality == "output":
        common["initial"] = "calculated"
    elif variable.causality in ("parameter", "local"):
        common["initial"] = "exact"
    if version == "3.0":
        Xml.SubElement(parent, _KINDS[variable.kind, version], common | _values(variable))
        return
    scalar = Xml.SubElement(parent, "ScalarVariable", common)
    Xml.SubElement(scalar, _KINDS[variable.kind, version], _values(variable))


def _values(variable: Variable) -> dict[str, str]:
    found: dict[str, str] = {}
    if variable.unit:
        found["unit"] = variable.unit
        shown = UNITS[variable.unit].shown
        if shown is not None and variable.shown:
            found["displayUnit"] = shown[0]
    if variable.kind != "truth" and variable.causality in ("parameter", "input"):
        for word, bound in (("min", variable.low), ("max", variable.high)):
            if math.isfinite(bound):
                found[word] = _written(variable, bound)
    if variable.start is not None:
        found["start"] = _written(variable, variable.start)
    return found


def _written(variable: Variable, value: float) -> str:
    if variable.kind == "truth":
        return "true" if value else "false"
    return str(int(value)) if variable.kind == "integer" else repr(float(value))


def _structure_3(structure: Xml.Element, interface: Interface) -> None:
    """List the outputs; none follows an input at once: a sample lies between."""
    outputs = interface.numbered("output")
    for number, _output in outputs:
        found = {"valueReference": str(number), "dependencies": ""}
        Xml.SubElement(structure, "Output", found)
    for number, _output in outputs:
        Xml.SubElement(structure, "InitialUnknown", {"valueReference": str(number)})


def _structure_2(structure: Xml.Element, interface: Interface) -> None:
    for word, found in (("Outputs", {"dependencies": ""}), ("InitialUnknowns", {})):
        group = Xml.SubElement(structure, word)
        for number, _output in interface.numbered("output"):
            Xml.SubElement(group, "Unknown", {"index": str(number + 1)} | found)
