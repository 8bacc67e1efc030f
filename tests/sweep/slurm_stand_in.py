"""A stand-in for SLURM's commands: `sbatch` starts jobs at once, `squeue` lists those that run.

Linked into a folder of the path under each command's name; jobs and what is asked of them are files beside the links.
"""

import os
import subprocess
import sys
import time
from pathlib import Path

PLACE = Path(sys.argv[0]).absolute().parent


def sbatch(script: str) -> None:
    lines = Path(script).read_text().splitlines()
    flags = dict(line[len("#SBATCH --") :].partition("=")[::2] for line in lines if line.startswith("#SBATCH"))
    if flags.get("partition") == "nowhere":
        sys.exit("sbatch: error: invalid partition specified: nowhere")
    number = str(1 + len(list(PLACE.glob("*.script"))))
    copy = PLACE / f"{number}.script"
    copy.write_text("\n".join(lines))
    last = flags.get("array", "").partition("%")[0].rpartition("-")[2]
    names = [f"{number}_{place}" for place in range(int(last) + 1)] if last else [number]
    for name in names:
        (PLACE / f"{name}.job").write_text("PENDING")
        command = [str(PLACE / "job"), name, str(copy), flags.get("dependency", "")]
        subprocess.Popen(command, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    print(f"Submitted batch job {number}")


def job(name: str, script: str, dependency: str) -> None:
    """One job: waits for another where it depends on one, runs the script, and is no longer in the queue."""
    state = PLACE / f"{name}.job"
    array, _, place = name.partition("_")
    own = {"SLURM_JOB_ID": name, **({"SLURM_ARRAY_JOB_ID": array, "SLURM_ARRAY_TASK_ID": place} if place else {})}
    while dependency and (before := (PLACE / f"{dependency.partition(':')[2]}.job").read_text()) != "COMPLETED":
        if before == "FAILED":
            state.write_text("FAILED")
            return
        time.sleep(0.05)
    state.write_text("RUNNING")
    with (PLACE / f"{name}.log").open("a") as log:
        ended = subprocess.run(["bash", script], env={**os.environ, **own}, stdout=log, stderr=log, check=False)
    state.write_text("FAILED" if ended.returncode else "COMPLETED")


def squeue(*options: str) -> None:
    asked = [option.partition("=")[2] for option in options if option.startswith("--jobs=")]
    for path in PLACE.glob("*.job"):
        state = path.read_text()
        if state in ("PENDING", "RUNNING") and (not asked or path.stem in asked):
            print(state if "--format=%T" in options else f"{path.stem} {state}")


def srun(*options: str) -> None:
    command = options[options.index(next(option for option in options if Path(option).name.startswith("python"))) :]
    os.execv(command[0], command)


def scontrol(verb: str, name: str) -> None:
    (PLACE / f"{name}.{verb}").touch()


if __name__ == "__main__":
    globals()[Path(sys.argv[0]).name](*sys.argv[1:])
