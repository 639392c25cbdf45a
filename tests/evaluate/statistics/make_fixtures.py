# SPDX-License-Identifier: BSD-3-Clause
"""Writes scipy_values.txt: data and what scipy says of them, a second oracle of evaluate/statistics.

/usr/bin/python3 tests/evaluate/statistics/make_fixtures.py tests/evaluate/statistics/scipy_values.txt
Needs Debian's python3-scipy.
"""
import sys

import numpy
import scipy
from scipy import stats


def main() -> None:
    random = numpy.random.default_rng(14)
    with open(sys.argv[1], "w", encoding="utf-8") as out:
        def put(name, *values):
            out.write(" ".join([name] + [f"{v:.15g}" for v in values]) + "\n")

        out.write(f"# scipy {scipy.__version__}, numpy {numpy.__version__}\n")

        def difference(x, y, axis=-1):
            return numpy.mean(x, axis=axis) - numpy.mean(y, axis=axis)

        for k, (m, n) in enumerate([(8, 8), (5, 9), (3, 4)]):
            x, y = random.normal(0.5, 1, m), random.normal(0, 1, n)
            one_sided = [stats.permutation_test((x, y), difference, n_resamples=numpy.inf, alternative=a,
                                                vectorized=True).pvalue for a in ("greater", "less")]
            put(f"between.{k}.x", *x)
            put(f"between.{k}.y", *y)
            put(f"between.{k}.p", min(1, 2 * min(one_sided)))
        for k, n in enumerate([5, 8, 12]):
            d = random.normal(0.5, 1, n)
            one_sided = [stats.permutation_test((d,), lambda v, axis=-1: numpy.mean(v, axis=axis),
                                                permutation_type="samples", n_resamples=numpy.inf, alternative=a,
                                                vectorized=True).pvalue for a in ("greater", "less")]
            put(f"pairs.{k}.d", *d)
            put(f"pairs.{k}.p", min(1, 2 * min(one_sided)))
            put(f"pairs.{k}.wilcoxon.p", stats.wilcoxon(d, method="exact").pvalue)
        d = random.exponential(1, 15)
        interval = stats.bootstrap((d,), numpy.mean, n_resamples=200_000, method="BCa", random_state=random,
                                   batch=1000).confidence_interval
        put("bca.d", *d)
        put("bca.interval", *interval)


if __name__ == "__main__":
    main()
