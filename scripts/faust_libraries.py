# SPDX-License-Identifier: MIT
"""Reads the documentation of our Faust libraries, which has the form of the Faust libraries
(github.com/grame-cncm/faustlibraries). For the scripts beside this file.
"""

import dataclasses
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[1]
LIBRARIES = ["contactspline", "contactspline_modal", "contactspline_instruments"]
BLOCK = re.compile(r"^//-+`\((\w+)\.\)(\w+)`-+\n((?://(?!-).*\n)*)//-+\n((?:declare .*\n)*)", re.M)
DEFINITION = re.compile(r"^([A-Za-z_]\w*)(?:\(([^)]*)\))?\s*=(?! library\()", re.M)


@dataclasses.dataclass
class Function:
    """A documented function: text of its comment, names of its own declarations."""
    prefix: str
    name: str
    text: str
    declared: set

    def under(self, heading):
        """The code under a heading; empty if there is none."""
        found = re.search(rf"#### {heading}\s*```\n(.*?)```", self.text, re.S)
        return found.group(1) if found else ""

    @property
    def usage(self):
        return self.under("Usage").strip()

    @property
    def summary(self):
        """The first sentence, up to its first comma."""
        description = " ".join(self.text.partition("####")[0].split())
        return re.split(r"[.,;:]\s", description + " ")[0]

    @property
    def imports(self):
        return re.findall(r"^\w+ = library\(.*\n", self.under("Test"), re.M)

    @property
    def test(self):
        """The definition of NAME_test."""
        return re.sub(r"^\w+ = library\(.*\n", "", self.under("Test"), flags=re.M)


class Library:
    def __init__(self, name):
        self.name = name
        self.text = (ROOT / f"faust/{name}.lib").read_text()
        self.prefix = re.search(r"Its usual prefix is `(\w+)`", self.text).group(1)
        self.functions = [Function(prefix, function, re.sub(r"^// ?", "", text, flags=re.M),
                                   set(re.findall(rf"^declare {function} (\w+) \"", declared, re.M)))
                          for prefix, function, text, declared in BLOCK.findall(self.text)]

    @property
    def parameters(self):
        """The public definitions: their parameters by name. What is for the library alone stands in PREFIX_internal."""
        return {name: re.findall(r"[^\s,]+", given) for name, given in DEFINITION.findall(self.text)
                if name != f"{self.prefix}_internal"}

    def controls(self, name):
        """The names in an environment of controls; none if it is something else."""
        found = re.search(rf"^{name}\b[^;]*?= environment {{\n(.*?)^}};", self.text, re.M | re.S)
        return re.findall(r"^  (\w+) =", found.group(1), re.M) if found and (name.endswith("_controls") or not self.parameters[name]) else []


def libraries():
    return [Library(name) for name in LIBRARIES]
