# Plant or estimator of a config as an FMU for co-simulation, FMI 2.0 or 3.0.
"""python -m pneuservo.fmu CONFIG FMU [--model plant | estimator] [--fmi 2 | 3] [--force]

The FMU holds the config and the program's own code: it computes what `simulate` and `run` compute, bit for bit. A
communication step is a whole number of the config's periods. Parameters are the numbers of the config by their paths;
they are set before the initialisation ends. It runs on the kind of processor that wrote it (x86-64, with FMI 3.0
also aarch64), with the libraries of Debian 12 (fmt, yaml-cpp).
"""
import argparse
import json
import lzma
import math
import os
import pathlib
import platform
import sys
import uuid
import zipfile
from typing import Any, Dict, List, Union
from xml.etree import ElementTree

from . import Config, InputError, __version__
from .errors import file_there
from ._core import _fmu_variables

_IDENTIFIER = "pneuservo_fmu"
_LIBRARY = pathlib.Path(__file__).with_name(f"{_IDENTIFIER}.so.xz")
_FOLDERS = {"2": {"x86_64": "linux64"}, "3": {"x86_64": "x86_64-linux", "aarch64": "aarch64-linux"}}
_UNITS = {"-": "1"}
Variables = List[Dict[str, Any]]


def _number(value: float) -> str:
    return repr(float(value))


def _attributes(variable: Dict[str, Any]) -> Dict[str, str]:
    """Unit, start and range, as both versions spell them."""
    out = {}
    if variable["unit"]:
        out["unit"] = _UNITS.get(variable["unit"], variable["unit"])
    if variable["causality"] in ("input", "parameter"):
        out["start"] = _number(variable["start"])
    for name, key in (("min", "minimum"), ("max", "maximum")):
        if math.isfinite(variable[key]):
            out[name] = _number(variable[key])
    return out


def _role(variable: Dict[str, Any]) -> Dict[str, str]:
    causality = variable["causality"]
    out = {"causality": causality, "variability": "fixed" if causality == "parameter" else "continuous"}
    if causality == "parameter":
        out["initial"] = "exact"
    elif causality == "output":
        out["initial"] = "calculated"
    return out


def _frame(config: Config, model: str, fmi: str, token: str, variables: Variables) -> ElementTree.Element:
    """The description down to its variables."""
    root = ElementTree.Element("fmiModelDescription", {
        "fmiVersion": {"2": "2.0", "3": "3.0"}[fmi], "modelName": f"{config.name} ({model})",
        {"2": "guid", "3": "instantiationToken"}[fmi]: token,
        "description": f"{model} of the pneumatic servo axis {config.name}", "generationTool": f"pneuservo {__version__}",
        "variableNamingConvention": "flat"})
    kind = {"modelIdentifier": _IDENTIFIER, "canHandleVariableCommunicationStepSize": "true"}
    kind["canGetAndSetFMUstate" if fmi == "2" else "canGetAndSetFMUState"] = "true"
    if fmi == "2":
        kind["canNotUseMemoryManagementFunctions"] = "true"
    else:
        kind["fixedInternalStepSize"] = _number(config.period_s)
    ElementTree.SubElement(root, "CoSimulation", kind)
    units = ElementTree.SubElement(root, "UnitDefinitions")
    for unit in sorted({_attributes(v)["unit"] for v in variables if v["unit"]}):
        ElementTree.SubElement(units, "Unit", {"name": unit})
    ElementTree.SubElement(ElementTree.SubElement(root, "LogCategories"), "Category", {"name": "logStatusError"})
    ElementTree.SubElement(root, "DefaultExperiment", {"startTime": "0.0", "stopTime": _number(config.duration_s),
                                                       "stepSize": _number(config.period_s)})
    return root


def _description_2(root: ElementTree.Element, variables: Variables) -> None:
    model = ElementTree.SubElement(root, "ModelVariables")
    known = [v for v in variables if v["causality"] != "independent"]
    for v in known:
        one = ElementTree.SubElement(model, "ScalarVariable", {"name": v["name"], "valueReference": str(v["reference"]),
                                                               "description": v["help"], **_role(v)})
        ElementTree.SubElement(one, "Real", _attributes(v))
    structure = ElementTree.SubElement(root, "ModelStructure")
    for part in ("Outputs", "InitialUnknowns"):
        unknowns = ElementTree.SubElement(structure, part)
        for index, v in enumerate(known, 1):
            if v["causality"] == "output":
                ElementTree.SubElement(unknowns, "Unknown", {"index": str(index)})


def _description_3(root: ElementTree.Element, variables: Variables) -> None:
    model = ElementTree.SubElement(root, "ModelVariables")
    for v in variables:
        ElementTree.SubElement(model, "Float64", {"name": v["name"], "valueReference": str(v["reference"]),
                                                  "description": v["help"], **_role(v), **_attributes(v)})
    structure = ElementTree.SubElement(root, "ModelStructure")
    for part in ("Output", "InitialUnknown"):
        for v in variables:
            if v["causality"] == "output":
                ElementTree.SubElement(structure, part, {"valueReference": str(v["reference"])})


def _library() -> bytes:
    try:
        return lzma.decompress(_LIBRARY.read_bytes())
    except (OSError, lzma.LZMAError) as error:
        raise InputError(f"{_LIBRARY}: found no whole library of the FMU ({error}), expected it as it was installed: "
                         "install the package again") from error


def write(config: Config, path: Union[str, os.PathLike], model: str = "plant", fmi: Union[int, str] = 2,
          replace: bool = False) -> None:
    """Writes the FMU. model: "plant" (commands [V] in, what ideal sensors show out) or "estimator" (port pressures,
    position, velocity, command in, chamber pressures out). fmi: 2 or 3, the version of the interface.

    Raises InputError for a rig that is no cylinder or servo table, another model or version, another processor, or a
    file that is there, unless replace.
    """
    version = str(fmi).split(".")[0]
    if version not in _FOLDERS:
        raise InputError(f"fmi: found {fmi!r}, expected 2 or 3")
    folder = _FOLDERS[version].get(platform.machine())
    if folder is None:
        raise InputError(f"fmi: found the processor {platform.machine()}, expected {' or '.join(_FOLDERS[version])} "
                         f"for FMI {version}")
    variables = _fmu_variables(config, model)
    text = config.to_yaml()
    token = "{%s}" % uuid.uuid5(uuid.NAMESPACE_OID, "\n".join((__version__, model, version, text)))
    root = _frame(config, model, version, token, variables)
    (_description_2 if version == "2" else _description_3)(root, variables)
    ElementTree.indent(root)
    library = _library()
    try:
        archive = zipfile.ZipFile(path, "w" if replace else "x", zipfile.ZIP_DEFLATED)
    except FileExistsError:
        raise file_there(path) from None
    with archive:
        # First and as it is: the program knows its own FMUs by how they begin (src/program/output_files.cpp).
        archive.writestr("resources/fmu.json", json.dumps({"pneuservo": __version__, "model": model, "token": token}),
                         zipfile.ZIP_STORED)
        archive.writestr("modelDescription.xml", ElementTree.tostring(root, encoding="utf-8", xml_declaration=True))
        archive.writestr("resources/config.yaml", text)
        binary = zipfile.ZipInfo(f"binaries/{folder}/{_IDENTIFIER}.so")
        binary.external_attr = 0o755 << 16
        archive.writestr(binary, library, zipfile.ZIP_DEFLATED)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m pneuservo.fmu", 
                                     description="Writes the plant or the estimator of a config as an FMU for co-simulation.")
    parser.add_argument("config", metavar="CONFIG", help="rig of a cylinder or a servo table")
    parser.add_argument("fmu", metavar="FMU", help="file to write, named *.fmu")
    parser.add_argument("--model", choices=("plant", "estimator"), default="plant", help="what it computes (plant)")
    parser.add_argument("--fmi", choices=("2", "3"), default="2", help="version of the interface (2)")
    parser.add_argument("--set", metavar="PATH=VALUE", action="append", default=[], help="overrides a key of the config")
    parser.add_argument("--force", action="store_true", help="replaces a file that is there")
    given = parser.parse_args()
    try:
        write(Config(given.config, given.set), given.fmu, given.model, given.fmi, given.force)
    except (InputError, OSError) as error:
        print(f"pneuservo.fmu: {error}", file=sys.stderr)
        return 2
    print(f"{given.fmu}: {given.model}, FMI {given.fmi}.0, {os.path.getsize(given.fmu) / 1e6:.1f} MB", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
