#!/usr/bin/env python3
"""Compares `halfshade truth SCENE -o TRUTH.exr` with Mitsuba's answer to the scene beside this file.

Rays go exactly through the centres of pixels, as those of the truth do. Both answers have a standard error, so that
z = (Mitsuba - truth) / hypot(errors) should have mean 0 and standard deviation 1 over pixels and channels. Prints these as
JSON, with the shares of |z| above 3 and of light, (sum Mitsuba)/(sum truth) - 1, with its own standard error.
Pixels that see nothing, and those whose interpolated normal is turned away from the eye, which both programs mend in their
own ways, are left out and counted.
"""

import argparse
import json
import math
import pathlib

import drjit as dr
import mitsuba as mi

import render

# Rays at once: memory for a gigabyte or so.
MOST_RAYS = 1 << 21


def channels(path):
    """Columns, rows, and the values of each channel of an OpenEXR file by name."""
    bitmap = mi.Bitmap(str(path))
    names = [field.name for field in bitmap.struct_()]
    width, height = bitmap.size()
    flat = list(mi.TensorXf(bitmap).array)
    return width, height, {name: flat[i :: len(names)] for i, name in enumerate(names)}


def rays_through(sensor, size, pixels):
    """Rays through the centres of pixels."""
    x, y = pixels % size[0], pixels // size[0]
    place = mi.Point2f((x + 0.5) / size[0], (y + 0.5) / size[1])
    return sensor.sample_ray(0.0, 0.5, place, mi.Point2f(0.5))[0]


def is_compared(scene, ray):
    """Whether a surface is seen whose normal lies on the side of its face."""
    si = scene.ray_intersect_preliminary(ray).compute_surface_interaction(ray)
    to_eye = -ray.d
    return si.is_valid() & (dr.dot(si.n, to_eye) * dr.dot(si.sh_frame.n, to_eye) > 0)


def vectorized(scene, size, samples, seed):
    """Sums and sums of squares of each pixel's samples, channel by channel, by wavefronts."""
    count = size[0] * size[1]
    integrator, sensor = scene.integrator(), scene.sensors()[0]
    all_pixels = dr.arange(mi.UInt32, count)
    compared = list(is_compared(scene, rays_through(sensor, size, all_pixels)))
    sums = [[dr.zeros(mi.Float64, count) for _ in range(3)] for _ in range(2)]
    per_pass = max(1, min(samples, MOST_RAYS // count))
    done = 0
    while done < samples:
        now = min(per_pass, samples - done)
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(seed + done, count * now)
        pixels = dr.arange(mi.UInt32, count * now) // now
        color = integrator.sample(scene, sampler, rays_through(sensor, size, pixels))[0]
        for channel in range(3):
            value = mi.Float64(color[channel])
            dr.scatter_reduce(dr.ReduceOp.Add, sums[0][channel], value, pixels)
            dr.scatter_reduce(dr.ReduceOp.Add, sums[1][channel], value * value, pixels)
        dr.eval(sums)
        done += now
    return compared, [[list(channel) for channel in part] for part in sums]


def one_by_one(scene, size, samples, seed):
    """The same, without LLVM."""
    integrator, sensor = scene.integrator(), scene.sensors()[0]
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(seed)
    count = size[0] * size[1]
    sums, compared = [[[0.0] * count for _ in range(3)] for _ in range(2)], []
    for pixel in range(count):
        ray = rays_through(sensor, size, pixel)
        compared.append(bool(is_compared(scene, ray)))
        for _ in range(samples if compared[-1] else 0):
            color = integrator.sample(scene, sampler, ray)[0]
            for channel in range(3):
                sums[0][channel][pixel] += color[channel]
                sums[1][channel][pixel] += color[channel] ** 2
    return compared, sums


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("truth", type=pathlib.Path)
    parser.add_argument("--samples", type=int, default=1024, help="samples per pixel")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--table", type=pathlib.Path, help="write pixel, channel, both values, error and z as CSV")
    render.add_variant(parser)
    arguments = parser.parse_args()
    scene = render.load(arguments.variant)
    width, height, truth = channels(arguments.truth)
    if list(scene.sensors()[0].film().size()) != [width, height]:
        parser.error(f"{arguments.truth} is {width}x{height}, and the scene's camera has another resolution")
    is_scalar = mi.variant().startswith("scalar")
    estimate = one_by_one if is_scalar else vectorized
    compared, (sums, squares) = estimate(scene, (width, height), arguments.samples, arguments.seed)

    n, rows, exact, left_out = arguments.samples, [], 0, 0
    for pixel in range(width * height):
        if not compared[pixel]:
            left_out += 1
            continue
        for channel, name in enumerate("RGB"):
            mean = sums[channel][pixel] / n
            variance = max(squares[channel][pixel] / n - mean * mean, 0.0) / max(n - 1, 1)
            expected, error = truth[name][pixel], math.hypot(variance**0.5, truth[f"stderr.{name}"][pixel])
            # Where all samples agree there is no noise to measure by, but rounding.
            rounding = 1e-4 * max(mean, expected)
            if error <= rounding:
                exact += 1
                error = rounding
            if error > 0.0:
                rows.append((pixel, name, mean, expected, error, (mean - expected) / error))
    z = [row[5] for row in rows]
    count = max(len(z), 1)
    mean_z = sum(z) / count
    light = sum(row[3] for row in rows)
    print(json.dumps({
        "variant": mi.variant(),
        "values": len(z),
        "left_out": left_out,
        "exact": exact,
        "mean_z": mean_z,
        "sd_z": (sum((x - mean_z) ** 2 for x in z) / count) ** 0.5,
        "share_above_3": sum(abs(x) > 3.0 for x in z) / count,
        "largest_z": max((abs(x) for x in z), default=0.0),
        "light_difference": (sum(row[2] for row in rows) - light) / light if light else 0.0,
        "light_standard_error": sum(row[4] ** 2 for row in rows) ** 0.5 / light if light else 0.0,
    }))
    if arguments.table:
        lines = ["pixel,channel,mitsuba,truth,error,z"] + [",".join(map(str, row)) for row in rows]
        arguments.table.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
