"""Builds the extension with CMake; what the package is stands in pyproject.toml."""

import os
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

root = Path(__file__).resolve().parent


class CMakeBuild(build_ext):
    def build_extension(self, extension):
        folder = Path(self.build_temp).resolve() / "cmake"
        target = Path(self.get_ext_fullpath(extension.name)).resolve().parent
        subprocess.run(
            ["cmake", "-S", root, "-B", folder, "-D", "CMAKE_BUILD_TYPE=Release", "-D", "SPRINGSTAB_TESTS=OFF",
             "-D", f"Python_EXECUTABLE={sys.executable}"],
            check=True)
        subprocess.run(
            ["cmake", "--build", folder, "--parallel", str(os.cpu_count()), "--target", "springstab_python"],
            check=True)
        target.mkdir(parents=True, exist_ok=True)
        self.copy_file(folder / "python" / "springstab" / self.get_ext_filename("_core"), target)


setup(ext_modules=[Extension("springstab._core", sources=[])], cmdclass={"build_ext": CMakeBuild})
