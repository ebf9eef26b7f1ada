# SPDX-License-Identifier: Apache-2.0
"""Runs every benchmark and the stability study, and draws the page.

    bench/run [--full] [--build DIR] [--out DIR] [--repetitions N] [--plan] [--resume]
              [--jobs N] [--only PROGRAM...]

Installs what is missing of the Debian packages that this needs (scripts/install-packages bench; not
with --plan and --draw) and builds in DIR (build-bench) unless the programs are there; what is still
missing then, a peer's library above all, ends it before anything is measured. Quick by default: 5 to 10 minutes on two
cores; --full takes two hours and a half. --jobs 2 runs two programs at once: that
shows that all of them run and are right, and its times are no measurement. --only bench_finite runs
that program alone. Result:
OUT/index.html with its figures as SVG files, results.json, results.csv, stability.csv, scenes.csv,
convergence.csv, finite-stability.csv, finite-fractures.csv. They are written after every program; --resume goes on with a run that was ended,
on the same machine. bench/run --draw DIR takes the ratios of a results folder, judges its cells and
draws its page again.
Exit code 1: something is WRONG, no number, failed or missing (said on stderr and on the page);
2: wrong usage; 3: a package, a peer or a program is missing, or the build failed.
"""
import argparse
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(HERE))
from suite import checks, machine, page, programs, results  # noqa: E402


def build(folder):
    """The bench programs and what they run; the rest of the project is not asked for."""
    source = HERE.parent
    subprocess.run(["cmake", "-S", source, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                    "-DSUNDER_BENCH=ON", "-DSUNDER_BENCH_PEERS=ON"], check=True,
                   stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", folder, "--target", "sunder_program", "bench/all"],
                   check=True, stdout=sys.stderr)


def tell_plan(mode, only):
    shares = programs.planned(mode, only)
    for program, share in shares:
        print(f"{share.seconds:5.0f} s  {program.name}: {program.about}", file=sys.stderr)
    total = sum(share.seconds for _, share in shares)
    print(f"{total:5.0f} s  in all, roughly, on two idle cores", file=sys.stderr)


def earlier(folder, about):
    """The results of a run that was ended. Raises BadResults where it was of another kind; each
    program's commit stands on the page."""
    outcome = results.read(folder)
    for key in ("mode", "only", "cpu", "cores", "mesa"):
        if outcome["machine"].get(key) != about.get(key):
            raise results.BadResults(f"{folder} has results of another {key} "
                                     f"({outcome['machine'].get(key)}, now {about.get(key)}); "
                                     "give another --out")
    return outcome


def renewed(folder):
    """The results of a folder, what follows from them concluded again."""
    outcome = programs.conclude(results.read(folder))
    results.write(folder, outcome)
    return outcome


def measure(options, mode):
    about = machine.describe(options.build, HERE.parent)
    about["mode"] = mode
    if options.only:
        about["only"] = sorted(options.only)
    outcome = (earlier(options.out, about) if options.resume
               else {"machine": about, **programs.nothing_yet()})
    outcome["peers"] = programs.peer_settings(options.build)
    outcome["finite_peers"] = programs.finite_settings(options.build)
    return programs.run_all(options.build, mode, options.repetitions, outcome,
                            lambda done: results.write(options.out, done), about["commit"],
                            options.jobs, options.only)


def draw(folder, outcome):
    page.write(folder, outcome)
    print(folder / "index.html")
    found = checks.problems(outcome)
    for problem in found:
        print(f"not good: {problem}", file=sys.stderr)
    return int(bool(found))


def arguments():
    parser = argparse.ArgumentParser(prog="bench/run",
                                     description="Runs every benchmark and draws the page.")
    parser.add_argument("--full", action="store_true", help="all sizes and pairs: over an hour")
    parser.add_argument("--build", default="build-bench", type=pathlib.Path)
    parser.add_argument("--out", default="bench-results", type=pathlib.Path)
    parser.add_argument("--only", action="append", default=[], metavar="PROGRAM",
                        help="this program of bench/, may be repeated; all otherwise")
    parser.add_argument("--repetitions", type=int, help="instead of each program's own number")
    parser.add_argument("--jobs", type=int, default=1,
                        help="programs at once; with more than 1 the times are no measurement")
    parser.add_argument("--resume", action="store_true", help="go on with a run that was ended")
    parser.add_argument("--plan", action="store_true", help="tell what would run and how long")
    parser.add_argument("--draw", type=pathlib.Path, metavar="DIR", help="draw DIR's page again")
    options = parser.parse_args()
    if options.repetitions is not None and options.repetitions < 1:
        parser.error("--repetitions must be 1 or more")
    known = {p.name for p, _ in programs.planned("full")}
    if unknown := sorted(set(options.only) - known):
        parser.error(f"--only {unknown[0]}: there are {', '.join(sorted(known))}")
    if options.jobs < 1:
        parser.error("--jobs must be 1 or more")
    return options


def main():
    options = arguments()
    mode = "full" if options.full else "quick"
    try:
        if options.draw:
            return draw(options.draw, renewed(options.draw))
        tell_plan(mode, options.only)
        if options.plan:
            return 0
        options.out.mkdir(parents=True, exist_ok=True)
        build(options.build)
        programs.expect_all(options.build, mode, options.only)
        outcome = measure(options, mode)
        return draw(options.out, outcome)
    except KeyboardInterrupt:
        print("\nbench/run: ended; --resume goes on after the last program that was done",
              file=sys.stderr)
        return 130
    except (results.BadResults, OSError, subprocess.CalledProcessError) as error:
        print(f"bench/run: {error}", file=sys.stderr)
        return 3


if __name__ == "__main__":
    sys.exit(main())
