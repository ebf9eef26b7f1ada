# SPDX-License-Identifier: Apache-2.0
"""The C interface as a page: what sunder.h says, in its order."""
import re

_SECTION = re.compile(r"/\* ---- (.*?) -+ \*/")
_NAME = re.compile(r"typedef struct (\w+) \{|SUNDER_API [\w ]+?\**\s*(sunder_\w+)\(|typedef [^;{]*?\(\*(\w+)\)"
                   r"|typedef [^;{]* (\w+);|#define (SUNDER_\w+_INIT)", re.S)


def _blocks(lines):
    """(comment, declaration) each; a declaration may have several lines."""
    comment, code, depth = [], [], 0
    for line in lines:
        text = line.rstrip()
        if not code and re.match(r"\s*//[/ ]? ?", text) and not depth:
            comment.append(re.sub(r"^\s*///? ?", "", text))
            continue
        if not code and not text:
            if comment:
                yield comment, []
            comment = []
            continue
        if not code and text.startswith("#") and not re.match(r"#define SUNDER_(VERSION_|\w+_INIT)", text):
            continue
        code.append(text)
        bare = re.sub(r"//.*", "", text)
        depth += bare.count("{") - bare.count("}")
        macro = code[0].startswith("#define")
        if depth == 0 and (bare.rstrip().endswith(";") or macro and not bare.rstrip().endswith("\\")):
            yield comment, code
            comment, code = [], []


def _title(code):
    found = _NAME.search("\n".join(code))
    return next(filter(None, found.groups()), None) if found else None


def page(header: str) -> str:
    """Markdown of a header's text. Raises ValueError where a function of it would be missing."""
    head, _, rest = header.partition("#ifndef SUNDER_SUNDER_H")
    out = ["# C interface", ""]
    out += [re.sub(r"^// ?", "", line) for line in head.splitlines() if not line.startswith("// SPDX")]
    lines = rest.splitlines()
    section, pending = None, []
    for line in lines + ["/* ---- end ---- */"]:
        found = _SECTION.match(line.strip())
        if not found:
            pending.append(line)
            continue
        out += ["", f"## {section}" if section else "## Version", ""]
        for comment, code in _blocks(pending):
            title = _title(code) if code else None
            if title and not title.endswith("_INIT"):
                out += [f"### `{title}`", ""]
            if comment:
                out += [*comment, ""]
            if code:
                out += ["```c", *code, "```", ""]
        section, pending = found[1], []
    text = "\n".join(out) + "\n"
    missing = [name for name in re.findall(r"SUNDER_API [\w ]+?\**\s*(sunder_\w+)\(", header)
               if f"### `{name}`" not in text]
    if missing:
        raise ValueError(f"sunder.h has functions that the page lacks: {', '.join(missing)}")
    return text
