"""Prints the values of scikit-image that `src/ssim.rs` is tested against: python3 ssim_reference.py

Made with scikit-image 0.26.0, numpy 2.4.6.
"""

import numpy
from skimage.metrics import structural_similarity


def picture(width, height, value):
    rows = [[[min(value(x, y, c), 255) for c in range(3)] for x in range(width)] for y in range(height)]
    return numpy.array(rows, dtype=numpy.uint8)


def plain(x, y, c):
    return 40 + (x * x + 3 * y + 7 * c * x + x * y // 4) % 160


def noisy(x, y, c):
    return plain(x, y, c) + (x * 7919 + y * 104729 + c * 1299) % 31


def blurred(x, y, c):
    return sum(plain(x + i, y + j, c) for i in range(3) for j in range(3)) // 9


def flat(value):
    return lambda x, y, c: value


def similarity(name, size, a, b):
    a, b = picture(*size, a).astype(float), picture(*size, b).astype(float)
    settings = {"gaussian_weights": True, "sigma": 1.5, "use_sample_covariance": False, "data_range": 255}
    try:
        print(name, repr(float(structural_similarity(a, b, channel_axis=2, **settings))))
    except ValueError as error:
        print(name, "is refused:", error)


similarity("NOISY", (40, 32), plain, noisy)
similarity("BLURRED", (40, 32), plain, blurred)
similarity("CONSTANTS", (16, 16), flat(50), flat(200))
similarity("CONSTANT_AND_PLAIN", (20, 24), flat(100), plain)
similarity("BLACK_AND_WHITE", (12, 12), flat(0), flat(255))
similarity("INVERTED", (33, 17), plain, lambda x, y, c: 255 - plain(x, y, c))
similarity("SINGLE_WINDOW", (11, 11), plain, noisy)
similarity("SMALL", (7, 7), plain, noisy)
