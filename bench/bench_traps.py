#!/usr/bin/python3
"""How often npdr's findings notice a wrong world, and how often they accuse a right one.

    bench/bench_traps.py
    bench/bench_traps.py --only spring-delay --npdr OTHER/bin/npdr --work OTHER/bench-traps

Each world is a folder with what a user would have: CSV files, a study. It is imported and run. A finding
counts where it is a failure or a warning; a note doesn't. A world that was run by the same program with the same
options isn't run again, but with --again.
"""
import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import time
import zlib
from dataclasses import dataclass

import numpy as np
import trap_datasets
import trap_recordings
from trap_recordings import ROOT

# Words of the findings that carry no id, in the order in which they are looked for.
PROBES = [(name, re.compile(words)) for name, words in (
    ("wrong_rate.clock", r"dt is probably"),
    ("wrong_rate.swapped", r"columns (are )?swapped"),
    ("wrong_rate.scale", r"changes .* times as fast"),
    ("wrong_rate.unrelated", r"isn't the slope of"),
    ("wrong_rate.spikes", r"it was computed of an angle that wraps"),
    ("wrapped_angle", r"it wraps; add"),
    ("glitch", r"a glitch of the sensor"),
    ("leap", r" leaps by "),
    ("rollout_twice", r"holds the same numbers"),
    ("far_beginning", r"more than a turn from zero"),
    ("slow_clock", r"are long for a motion"),
    ("uneven_clock", r"--resample"),
    ("computed_rates", r"may be off by"),
    ("cut_file", r"its last line has no end"),
    ("truth_outside", r"outside of the prior"),
    ("recording_without_noise", r"observation_noise leaves"),
    ("loud_noise", r"noise as large as the motion"),
    ("not_repeatable", r"simulated again, alone"),
    ("shared_noise", r"share their noise"),
    ("no_noise", r"adds no observation noise"),
    ("order_of_rows", r"in another order than those of theta"),
    ("lost_precision", r"single precision"),
    ("same_rows", r"are the same|the very x of others"),
    ("outliers", r"further from all other values"),
    ("too_many_failed", r"max_failed_fraction"),
    ("failed_rows", r"rows failed|simulations failed"),
    ("rows_outside", r"outside of the support|outside of \[prior\]|lie outside"),
    ("coarse_first_states", r"inferred to first order"),
)]
# Severities of report.json by those that are counted here.
SEVERITIES = {"wrong": "fail", "suspicious": "warning"}
LOUD = {"fail": "!", "warning": "?"}
TOO_MANY_FAILED = 3  # exit status
FIT = "Least squares"
# What is said of any fault names none.
GENERAL = re.compile(r"simulator or noise lack( something)?|Look for [^.]*")


@dataclass
class World:
    seed: int
    device: str
    name: str
    is_right: bool
    cause: str  # a regular expression of what names it
    begin: callable  # of a generator: what has write(folder, options)
    edit: callable  # of that

    @property
    def folder(self):
        return f"{self.device}-{self.name}-{self.seed}"

    def write(self, folder, options):
        files = self.begin(np.random.default_rng([self.seed, zlib.crc32(f"{self.device} {self.name}".encode())]))
        self.edit(files)
        return files.write(folder, options)


def id_of(text):
    return next((name for name, words in PROBES if words.search(text)), "other: " + " ".join(text.split()[:6]))


def finding(phase, name, severity, text, method=""):
    return dict(phase=phase, id=name, severity=severity, text=text, method=method)


def found_in_output(phase, output, status):
    """Warnings, and why the command ended. Those of stages begin with "npdr: simulate default, seed 1, round 1: "."""
    found = []
    for line in output.splitlines():
        method = re.match(r"npdr: \w+ ([\w ]+), seed", line)
        text = line.partition("warning: ")[2]
        if text:
            found.append(finding(phase, id_of(text), "warning", text, method[1] if method else ""))
        elif status != 0 and not id_of(line).startswith("other"):
            found.append(finding(phase, id_of(line), "fail", line))
    if status != 0 and all(f["severity"] == "warning" for f in found):
        severity = "fail" if phase == "import" or status == TOO_MANY_FAILED else "broken"
        found.append(finding(phase, id_of(output), severity, output))
    return found


def found_in_report(path):
    """The worst first, then checks that fail for a reason that another has named."""
    found = []
    for checks in json.loads(path.read_text())["checks"]:
        for reason in checks["reasons"]:
            text = ". ".join(reason[key] for key in ("what", "evidence", "advice") if reason[key])
            severity = SEVERITIES.get(reason["severity"], reason["severity"])
            found.append(finding("report", reason["id"], severity, text, checks["method"]))
        said = {reason["check"] for reason in checks["reasons"]}
        found += [finding("report", title, "fail", "", checks["method"]) for title in checks["failed"]
                  if title not in said]
    return found


def run(world, options):
    """Findings of a world, in the order in which they are said."""
    folder = options.work / world.folder
    result = folder / "result.json"
    if result.exists() and not options.again:
        known = json.loads(result.read_text())
        if known["program"] == options.digest:
            return known
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    start = time.perf_counter()
    environment = os.environ | {"PYTHONPATH": str(ROOT / "pipeline/sources/python"), "OMP_NUM_THREADS": "1"}
    found = []
    commands = [world.write(folder, options), ["run", "study.toml", "-j", "1"]]
    for words in commands:
        done = subprocess.run([options.npdr, *words], cwd=folder, env=environment, text=True, check=False,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        with open(folder / "log.txt", "a", encoding="utf-8") as log:
            log.write(f"$ npdr {' '.join(words)}\n{done.stdout}{done.stderr}status {done.returncode}\n\n")
        output = done.stderr if words[0] == "run" else done.stdout + done.stderr
        found += found_in_output(words[0], output, done.returncode)
        if done.returncode != 0:
            break
    else:
        found += found_in_report(folder / "runs/world/report.json")
    if not options.keep:
        shutil.rmtree(folder / "runs", ignore_errors=True)
    known = dict(program=options.digest, seconds=time.perf_counter() - start, methods=methods_of(folder), found=found)
    result.write_text(json.dumps(known, indent=1))
    return known


def methods_of(folder):
    """Those of the study, and the fit that a recorded motion has by itself."""
    text = (folder / "study.toml").read_text()
    named = re.findall(r'\[\[method\]\]\nname = "(\w+)"', text)
    return named if named == ["dataset"] or "floor = false" in text else [FIT, *named]


class Outcome:
    """What was found of a world with one of its methods."""

    def __init__(self, world, method, found):
        self.world, self.method = world, method
        self.found = [f for f in found if f["method"] in ("", method)]
        self.loud = [f for f in self.found if f["severity"] in LOUD]
        self.is_broken = any(f["severity"] == "broken" for f in self.found)
        first = f"{self.loud[0]['id']}: {self.loud[0]['text']}" if self.loud else ""
        self.names_cause = bool(self.loud) and bool(re.search(world.cause, GENERAL.sub("", first)))

    def line(self):
        said = "accused" if self.loud else "fine"
        if not self.world.is_right:
            said = ("found, cause" if self.names_cause else "found") if self.loud else "MISSED"
        marks = [f["id"] + LOUD[f["severity"]] for f in self.loud]
        marks += [f"({f['id']})" for f in self.found if f["severity"] not in LOUD]
        kind = "right" if self.world.is_right else "wrong"
        return (f"{self.world.device:9} {self.world.name + ' ' + str(self.world.seed):23} {kind} {self.method:13} "
                f"{'BROKEN' if self.is_broken else said:13} {' '.join(dict.fromkeys(marks))}")


def share(part, whole):
    return f"{len(part):4} of {len(whole):4} ({100 * len(part) / len(whole) if whole else 0:3.0f} %)"


def print_summary(outcomes):
    print("\nmethod        wrong worlds found     first names the cause  right worlds accused")
    for method in (FIT, "default", "refine", "dataset"):
        its = [o for o in outcomes if o.method == method]
        wrong, right = [o for o in its if not o.world.is_right], [o for o in its if o.world.is_right]
        print(f"{method:13} {share([o for o in wrong if o.loud], wrong):22} "
              f"{share([o for o in wrong if o.names_cause], wrong):22} {share([o for o in right if o.loud], right)}")


def print_probes(outcomes):
    """Of worlds, whatever the methods."""
    by_world = {}
    for outcome in outcomes:
        world, ids = by_world.setdefault(outcome.world.folder, (outcome.world, set()))
        ids.update(f["id"] for f in outcome.loud)
    table = {}
    for world, ids in by_world.values():
        for name in ids:
            row = table.setdefault(name, [0, 0, 0])
            row[2 if world.is_right else 0] += 1
            row[1] += len(ids) == 1 and not world.is_right
    print("\nprobe                            found  alone  accused right ones")
    for name, (found, alone, accused) in sorted(table.items(), key=lambda row: -row[1][0]):
        print(f"{name:32} {found:5}  {alone:5}  {accused:5}")


def print_exceptions(outcomes):
    missed = sorted({o.world.folder for o in outcomes if not o.world.is_right and not o.loud}
                    - {o.world.folder for o in outcomes if o.loud})
    print(f"\nWrong worlds that no method found: {', '.join(missed) or 'none'}")
    print("\nRight worlds that were accused:")
    for o in outcomes:
        for f in o.loud if o.world.is_right else ():
            print(f"  {o.world.folder}, {o.method}: {f['id']}: {f['text'][:300]}")


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--npdr", type=pathlib.Path, default=ROOT / "build/release/bin/npdr", help="the program")
    parser.add_argument("--devices", default="dataset,worker,pendulum,spring,furuta", help="with commas between")
    parser.add_argument("--seeds", default="1", help="with commas between: worlds of each kind")
    parser.add_argument("--only", default="", help="a regular expression for DEVICE-WORLD-SEED")
    parser.add_argument("--work", type=pathlib.Path, default="bench-traps", help="folder of the worlds")
    parser.add_argument("-j", "--jobs", type=int, default=2, help="worlds at once, each on one core")
    parser.add_argument("--num-simulations", type=int, default=1000, help="of the default method")
    parser.add_argument("--num-networks", type=int, default=1, help="the same; a study has 5 that says nothing")
    parser.add_argument("--patience", type=int, default=10, help="epochs that a training waits; a study has 20")
    parser.add_argument("--again", action="store_true", help="run worlds that were run")
    parser.add_argument("--no-run", action="store_true", help="take those alone that were run")
    parser.add_argument("--keep", action="store_true", help="keep their artefacts and reports")
    parser.add_argument("--list", action="store_true", help="print the worlds and exit")
    return parser.parse_args()


def compile_library(options):
    """The simulator of the spring, as a user's."""
    options.library = options.work.resolve() / "spring.so"
    if options.library.exists():
        return  # maybe in use
    source, include = ROOT / "experiments/external/spring/spring.c", ROOT / "sim/library"
    subprocess.run(["cc", "-O3", "-march=native", "-shared", "-fPIC", f"-I{include}", str(source), "-o",
                    str(options.library), "-lm"], check=True)


def main():
    options = parse()
    kinds = [*trap_datasets.worlds(), *trap_recordings.worlds()]
    worlds = [World(int(seed), *kind) for seed in options.seeds.split(",") for kind in kinds]
    worlds = [w for w in worlds if w.device in options.devices.split(",") and re.search(options.only, w.folder)]
    if options.list:
        print("\n".join(f"{'right' if w.is_right else 'wrong'} {w.folder}" for w in worlds))
        return
    options.npdr = options.npdr.resolve()
    settings = f"{options.num_simulations} {options.num_networks} {options.patience}"
    options.digest = f"{hashlib.sha256(options.npdr.read_bytes()).hexdigest()[:16]} {settings}"
    options.work.mkdir(parents=True, exist_ok=True)
    compile_library(options)
    if options.no_run:
        worlds = [w for w in worlds if (options.work / w.folder / "result.json").exists()]
    outcomes, seconds = [], 0.0
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for world, known in zip(worlds, pool.map(lambda w: run(w, options), worlds)):
            seconds += known["seconds"]
            for method in known["methods"]:
                outcomes.append(Outcome(world, method, known["found"]))
                print(outcomes[-1].line(), flush=True)
    print_summary(outcomes)
    print_probes(outcomes)
    print_exceptions(outcomes)
    print(f"\n{len(worlds)} worlds, {seconds:.0f} s of one core each, options: {options.num_simulations} simulations, "
          f"{options.num_networks} networks, patience {options.patience}")


if __name__ == "__main__":
    main()
