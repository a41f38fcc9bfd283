"""Python messages of definitions that no wheel has, by the generators in the wheels: `messages.py DEFINITIONS OUT`.

Runs in the environment of rclpy. DEFINITIONS has a folder of `.msg` and `.srv` files for each package. Needs a C++
compiler.
"""

import contextlib
import io
import logging
import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import numpy as np
from rosidl_generator_c.cli import GenerateC
from rosidl_generator_py.cli import GeneratePython
from rosidl_typesupport_c.cli import GenerateCTypesupport
from rosidl_typesupport_fastrtps_c.cli import GenerateFastRTPSCTypesupport

PREFIX = Path(sys.prefix)
os.environ["AMENT_PREFIX_PATH"] = sys.prefix
IMPLEMENTATION = "rosidl_typesupport_c"
KINDS = ("rosidl_generator_c", "rosidl_generator_py", "rosidl_typesupport_c", "rosidl_typesupport_fastrtps_c")
RUNTIME = (
    "rosidl_runtime_c", "rosidl_typesupport_c", "rosidl_typesupport_fastrtps_c", "rosidl_typesupport_fastrtps_cpp",
    "rcutils", "fastcdr",
)  # fmt: skip
OF_ROS_1 = ("autoware_msgs",)  # of Autoware.AI
USED = (
    "std_msgs", "geometry_msgs", "shape_msgs", "sensor_msgs", "builtin_interfaces", "diagnostic_msgs", "service_msgs",
)  # fmt: skip


def generate(package: str, definitions: Path, out: Path) -> Path:
    """Write the C and Python code of a package; its folder."""
    source, made = out / "definitions" / package, out / package
    files = []
    for kind in ("msg", "srv"):
        for file in sorted((definitions / package).glob(f"*.{kind}")):
            (source / kind).mkdir(parents=True, exist_ok=True)
            shutil.copy(file, source / kind)
            files.append(f"{source}:{kind}/{file.name}")
    made.mkdir()
    for generator in (
        GenerateC("c"),
        GenerateCTypesupport("c", typesupport_implementations=["rosidl_typesupport_fastrtps_c"]),
        GenerateFastRTPSCTypesupport("fastrtps_c"),
        GeneratePython("py", typesupport_implementations=[IMPLEMENTATION]),
    ):
        with contextlib.redirect_stdout(io.StringIO()):
            generator.generate(package, files, [str(PREFIX / "share")], made)
    (made / "__init__.py").touch()
    return made


def compile_package(made: Path, out: Path) -> None:
    """Make the library that rclpy imports with a package."""
    folders = [out, PREFIX / "include", *(PREFIX / "include").iterdir(), sysconfig.get_paths()["include"]]
    flags = ["-O0", "-fPIC", "-w", *(f"-I{folder}" for folder in [*folders, np.get_include()])]
    every = out / f"{made.name}.cpp"  # in one piece: the headers take longer than the code
    every.write_text("".join(f'#include "{file}"\n' for file in sorted(made.rglob("*.cpp"))), encoding="utf-8")
    names = [*(f"{package}__{kind}" for package in USED for kind in KINDS), *RUNTIME]
    libraries = [str(PREFIX / "lib" / f"lib{name}.so") for name in names]
    target = made / f"{made.name}_s__{IMPLEMENTATION}.so"
    subprocess.run(["g++", "-std=c++17", *flags, "-c", str(every), "-o", f"{every}.o"], check=True)
    sources = [str(file) for file in sorted(made.rglob("*.c"))]
    command = ["gcc", *flags, "-shared", *sources, f"{every}.o", "-o", str(target), *libraries, "-lstdc++"]
    subprocess.run([*command, f"-Wl,-rpath,{PREFIX / 'lib'}"], check=True)


def main(definitions: str, out: str) -> None:
    logging.disable(logging.WARNING)  # of entry points that each wheel has twice
    to = Path(out).absolute()
    for folder in sorted(Path(definitions).absolute().iterdir()):
        if folder.is_dir() and folder.name not in OF_ROS_1:
            compile_package(generate(folder.name, folder.parent, to), to)


if __name__ == "__main__":
    main(*sys.argv[1:])
