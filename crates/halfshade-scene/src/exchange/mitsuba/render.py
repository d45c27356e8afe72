#!/usr/bin/env python3
"""Renders the scene beside this file with Mitsuba 3 (pip install mitsuba) to picture.exr."""

import argparse
import importlib
import pathlib
import sys

import mitsuba as mi

HERE = pathlib.Path(__file__).resolve().parent


def add_variant(parser):
    parser.add_argument("--variant", default="scalar_rgb", help="of Mitsuba: scalar_rgb needs nothing else; llvm_ad_rgb is many times "
                        "as fast and needs LLVM, version 17 or later (DRJIT_LIBLLVM_PATH says where)")


def load(variant):
    """The scene, in a variant of Mitsuba."""
    mi.set_variant(variant)
    sys.path.insert(0, str(HERE))
    importlib.import_module("halfshade_lobes")
    return mi.load_file(str(HERE / "scene.xml"))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--samples", type=int, default=256, help="samples per pixel")
    parser.add_argument("-o", "--output", default=str(HERE / "picture.exr"))
    add_variant(parser)
    arguments = parser.parse_args()
    scene = load(arguments.variant)
    mi.util.write_bitmap(arguments.output, mi.render(scene, spp=arguments.samples))


if __name__ == "__main__":
    main()
