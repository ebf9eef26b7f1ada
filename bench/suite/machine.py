# SPDX-License-Identifier: Apache-2.0
"""What the figures were measured on."""
import datetime
import os
import pathlib
import platform
import re
import subprocess


def _output(*command, folder=None):
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=60, cwd=folder)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""


def _cpu():
    text = pathlib.Path("/proc/cpuinfo").read_text()
    found = re.search(r"^model name\s*:\s*(.+)$", text, re.M)
    return found.group(1) if found else platform.machine()


def _version(package):
    return _output("dpkg-query", "-W", "-f=${Version}", package) or "none"


def describe(build, source):
    load = os.getloadavg()
    commit = _output("git", "rev-parse", "--short", "HEAD", folder=source)
    changed = _output("git", "status", "--porcelain", folder=source)
    devices = _output(str(pathlib.Path(build) / "app" / "sunder"), "devices")
    return {
        "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC"),
        "cpu": _cpu(),
        "cores": os.cpu_count(),
        "load_before": round(load[0], 2),
        "system": platform.platform(),
        "compiler": _output("c++", "--version").splitlines()[:1],
        "commit": commit + (" with changes" if changed else ""),
        "eigen": _version("libeigen3-dev"),
        "suitesparse": _version("libcholmod3"),
        "openblas": _version("libopenblas0-pthread"),
        "mesa": _version("mesa-vulkan-drivers"),
        "devices": devices.splitlines(),
    }
