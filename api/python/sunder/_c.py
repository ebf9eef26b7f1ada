# SPDX-License-Identifier: Apache-2.0
"""The C interface by ctypes. Structs, enumerations and functions are read from sunder.h, which lies
beside this file, so that nothing is declared twice."""
import ctypes as c
import os
import pathlib
import re

_HERE = pathlib.Path(__file__).resolve().parent
_SCALARS = {
    "double": c.c_double, "float": c.c_float, "int32_t": c.c_int32, "uint32_t": c.c_uint32,
    "int64_t": c.c_int64, "uint64_t": c.c_uint64, "uint8_t": c.c_uint8, "size_t": c.c_size_t,
    "char": c.c_char, "int": c.c_int,
}


def _without_comments(text):
    text = re.sub(r"/\*.*?\*/|//[^\n]*", " ", text, flags=re.S)
    return re.sub(r"^\s*#(?:[^\n]*\\\n)*[^\n]*$", "", text, flags=re.M)


class Struct(c.Structure):
    """A struct of the header; one that begins with struct_size sets it."""

    def __init__(self, **members):
        super().__init__(**members)
        if self._sized:
            self.struct_size = c.sizeof(self)

    _sized = False


class Header:
    """What a header declares: constants, structs by name, functions with their types."""

    def __init__(self, text):
        self.constants = {}
        self.structs = {}
        self.functions = {}
        self._types = dict(_SCALARS)
        text = _without_comments(text)
        pattern = (r"typedef struct (?P<struct>\w+) \{(?P<members>.*?)\} \w+;"
                   r"|typedef struct \w+\s*\*\s*(?P<handle>\w+);"
                   r"|typedef (?P<result>\w+) \(\*(?P<callback>\w+)\)\((?P<takes>.*?)\);"
                   r"|typedef (?P<of>\w+) (?P<alias>\w+);"
                   r"|enum \{(?P<enum>.*?)\};"
                   r"|SUNDER_API (?P<returns>[\w ]+?\**) ?(?P<function>sunder_\w+)\((?P<arguments>.*?)\);")
        for found in re.finditer(pattern, text, flags=re.S):
            self._take(found.groupdict())

    def _take(self, d):
        if d["struct"]:
            self._struct(d["struct"], d["members"])
        elif d["handle"]:
            self._types[d["handle"]] = c.c_void_p
        elif d["callback"]:
            self._types[d["callback"]] = c.CFUNCTYPE(
                self._type(d["result"]), *[t for _, t in self._arguments(d["takes"])])
        elif d["alias"]:
            self._types[d["alias"]] = self._types[d["of"]]
        elif d["enum"]:
            for item in re.sub(r"\s+", "", d["enum"]).split(","):
                if item:
                    name, _, value = item.partition("=")
                    self.constants[name] = int(value, 0)
        elif d["function"]:
            self.functions[d["function"]] = (self._type(d["returns"]), self._arguments(d["arguments"]))

    def _type(self, text):
        text = re.sub(r"\bconst\b", "", text).strip()
        name, stars = text.rstrip("* "), text.count("*")
        if name == "void":
            return c.c_void_p if stars else None
        if name == "char" and stars:
            return c.c_char_p
        # An array or struct by its address: whoever calls has looked at it.
        return c.c_void_p if stars else self._types[name]

    def _arguments(self, text):
        result = []
        for argument in filter(None, (a.strip() for a in re.sub(r"\s+", " ", text).split(","))):
            if argument == "void":
                continue
            name = re.match(r"(.*?)(\w+)(?:\[\d+\])?$", argument)
            kind = "void*" if argument.endswith("]") else name[1]
            result.append((name[2], self._type(kind)))
        return result

    def _struct(self, name, members):
        fields = []
        for member in filter(None, (m.strip() for m in re.sub(r"\s+", " ", members).split(";"))):
            kind, names = re.match(r"((?:const )?\w+ ?\**) ?(.*)$", member).groups()
            for one in names.split(","):
                sizes = [int(n) for n in re.findall(r"\[(\d+)\]", one)]
                stars = one.count("*")
                of = self._type(kind + "*" * stars)
                for size in reversed(sizes):
                    of = of * size
                fields.append((re.match(r"\W*(\w+)", one)[1], of))
        sized = fields[0][0] == "struct_size"
        self._types[name] = self.structs[name] = type(
            name, (Struct,), {"_fields_": fields, "_sized": sized})


def _find(name, variable):
    path = os.environ.get(variable)
    return pathlib.Path(path) if path else _HERE / name


header = Header(_find("sunder.h", "SUNDER_HEADER").read_text(encoding="utf-8"))
constants = header.constants
structs = header.structs
library = c.CDLL(str(_find("libsunder.so", "SUNDER_LIBRARY")))
for _name, (_result, _takes) in header.functions.items():
    _function = getattr(library, _name)
    _function.restype = _result
    _function.argtypes = [t for _, t in _takes]


def options(name):
    """A struct of options with the library's defaults."""
    struct = structs[name]()
    getattr(library, name + "_init")(c.byref(struct))
    return struct
