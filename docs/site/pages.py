#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Lays out the pages of the site for mkdocs: the documents, the references of C and Python made from
their sources, and a gallery of the scenes with pictures that the program makes.
    pages.py PROGRAM STAGE     into the folder STAGE: docs/ and mkdocs.yml"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

import c_reference
import python_reference

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parent.parent


def with_links(text, at_root):
    """Links as they stand among the pages: a document of docs/ by its name; what is no page is named
    without a link."""
    def link(found):
        name, target, anchor = found["name"], found["target"], found["anchor"] or ""
        target = target.removeprefix("docs/") if at_root else target
        if target == "../README.md":
            target = "index.md"
        if "/" not in target and (SOURCE / "docs" / target).is_file() or target == "index.md":
            return f"[{name}]({target}{anchor})"
        return name
    return re.sub(r"(?<!!)\[(?P<name>[^\]]*)\]\((?P<target>[^)#:]+)(?P<anchor>#[^)]*)?\)", link, text)


def place_documents(docs):
    for path in (SOURCE / "docs").glob("*.md"):
        (docs / path.name).write_text(with_links(path.read_text(encoding="utf-8"), False),
                                      encoding="utf-8")
    for path in (SOURCE / "docs").glob("*.png"):
        shutil.copy(path, docs)
    readme = (SOURCE / "README.md").read_text(encoding="utf-8")
    readme = with_links(readme, True).replace("](docs/", "](")
    (docs / "index.md").write_text(readme, encoding="utf-8")


def about(scene):
    """(title, what it shows) of a scene's file: its comment at the top."""
    text = scene.read_text(encoding="utf-8")
    title = re.search(r'^title = "(.*)"', text, flags=re.M)
    comment = re.match(r"(?:#.*\n)*", text)[0]
    lines = [line.lstrip("# ") for line in comment.splitlines() if "SPDX" not in line]
    return title[1] if title else scene.stem, " ".join(lines)


def picture(program, scene, work, to):
    """Runs a scene in the folder `work`, puts its picture at `to`; what the summary says of it.
    Raises CalledProcessError where the program fails."""
    subprocess.run([program, "run", scene, "--quiet", "--backend", "cpu", "--out", work], check=True,
                   stdout=subprocess.DEVNULL)
    shutil.copy(work / "figure.png", to)
    return json.loads((work / "summary.json").read_text(encoding="utf-8"))


def gallery(program, docs, work):
    (docs / "gallery").mkdir()
    out = ["# Gallery", "", "Every scene of `scenes/`, run by `sunder run SCENE` on the CPU when these pages "
           "were made; what a page says of a scene is the comment at its top.", ""]
    for scene in sorted((SOURCE / "scenes").rglob("*.toml")):
        name = scene.relative_to(SOURCE / "scenes").with_suffix("")
        file = "gallery/" + "-".join(name.parts) + ".png"
        summary = picture(program, scene, work / "-".join(name.parts), docs / file)
        title, text = about(scene)
        out += [f"## {title}", "", text, "", f"`sunder run scenes/{name}.toml`: "
                f"{len(summary['destroyed'])} of {summary['mesh']['tets']} elements destroyed, "
                f"{len(summary['cracks'])} cracks.", "",
                f"![{title}]({file})", ""]
    (docs / "gallery.md").write_text("\n".join(out), encoding="utf-8")


def main(program, stage):
    stage = pathlib.Path(stage).resolve()
    shutil.rmtree(stage, ignore_errors=True)
    docs = stage / "docs"
    docs.mkdir(parents=True)
    place_documents(docs)
    header = (SOURCE / "api/sunder/sunder.h").read_text(encoding="utf-8")
    (docs / "c.md").write_text(c_reference.page(header), encoding="utf-8")
    package = SOURCE / "api/python/sunder"
    (docs / "python-reference.md").write_text(python_reference.page(package), encoding="utf-8")
    gallery(program, docs, stage / "runs")
    theme = os.path.relpath(HERE / "theme", stage)
    (stage / "mkdocs.yml").write_text(
        (HERE / "mkdocs.yml").read_text(encoding="utf-8").replace("THEME", theme), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
