#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Packs the Python package with a built library into a wheel; nothing but Python is needed.
   wheel.py LIBSUNDER.so FOLDER      prints the path of the wheel"""
import base64
import hashlib
import pathlib
import re
import sys
import sysconfig
import zipfile

HERE = pathlib.Path(__file__).resolve().parent
HEADER = HERE.parent / "sunder" / "sunder.h"


def version():
    text = HEADER.read_text(encoding="utf-8")
    return ".".join(re.search(rf"SUNDER_VERSION_{part} (\d+)", text)[1]
                    for part in ("MAJOR", "MINOR", "PATCH"))


def contents(library):
    info = f"sunder-{version()}.dist-info"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    files = {f"sunder/{p.name}": p.read_bytes() for p in sorted((HERE / "sunder").iterdir())
             if p.suffix in (".py", ".typed")}
    files["sunder/sunder.h"] = HEADER.read_bytes()
    files["sunder/libsunder.so"] = library.resolve().read_bytes()
    files[f"{info}/METADATA"] = (
        f"Metadata-Version: 2.1\nName: sunder\nVersion: {version()}\n"
        "Summary: Soft tissue that tears, in real time\nLicense: Apache-2.0\n"
        "Requires-Python: >=3.11\nRequires-Dist: numpy\n").encode()
    files[f"{info}/WHEEL"] = (
        "Wheel-Version: 1.0\nGenerator: sunder\nRoot-Is-Purelib: false\n"
        f"Tag: py3-none-{platform}\n").encode()
    files[f"{info}/LICENSE"] = (HERE.parent.parent / "LICENSE").read_bytes()
    record = "".join(
        f"{name},sha256={base64.urlsafe_b64encode(hashlib.sha256(data).digest()).decode().rstrip('=')},"
        f"{len(data)}\n" for name, data in files.items())
    files[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    return f"sunder-{version()}-py3-none-{platform}.whl", files


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    name, files = contents(pathlib.Path(sys.argv[1]))
    folder = pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    # The same library makes the same bytes: no times.
    with zipfile.ZipFile(folder / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for file, data in files.items():
            entry = zipfile.ZipInfo(file, (1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            wheel.writestr(entry, data)
    print(folder / name)


if __name__ == "__main__":
    main()
