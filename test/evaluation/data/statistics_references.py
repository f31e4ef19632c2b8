"""Reference values for signed_rank_test.cc, written once by scipy 1.10.1 (Debian: python3-scipy):
scipy.stats.wilcoxon with Pratt's zeros and the normal approximation with its corrections, and the
exact distribution with ties and zeros by going through all signs.

    python3 statistics_references.py
"""

import itertools
import random

import scipy
from scipy.stats import rankdata, wilcoxon


def listed(values):
    return " ".join(repr(v) for v in values)


def by_all_signs(differences, pratt):
    """P of both sides over all 2^n signs of the differences that are not zero."""
    kept = differences if pratt else [d for d in differences if d != 0]
    ranks = [r for r, d in zip(rankdata([abs(d) for d in kept]), kept) if d != 0]
    signs = [d > 0 for d in kept if d != 0]
    plus = sum(r for r, s in zip(ranks, signs) if s)
    smaller = min(plus, sum(ranks) - plus)
    below = sum(
        sum(itertools.compress(ranks, s)) <= smaller + 1e-9
        for s in itertools.product((0, 1), repeat=len(ranks)))
    return plus, min(1.0, 2.0 * below / 2**len(ranks))


random.seed(8)
with open("signed_rank_scipy.csv", "w") as file:
    file.write(f"# scipy {scipy.__version__}: wilcoxon(zero_method, correction=True, mode='approx')\n")
    file.write("# exact: by going through all signs of the differences, given their ranks\n")
    file.write("#name,exact,zeros,v,p_value,differences\n")
    for name, n in (("ties_13", 13), ("ties_16", 16), ("ties_60", 60)):
        d = [float(round(random.gauss(0.7, 2.0))) for _ in range(n)]
        for zeros in ("pratt", "wilcox"):
            plus, p = by_all_signs(d, zeros == "pratt") if n < 20 else (None, None)
            if p is not None:
                file.write(f"{name},1,{zeros},{plus!r},{p!r},{listed(d)}\n")
            result = wilcoxon(d, zero_method=zeros, correction=True, mode="approx")
            kept = d if zeros == "pratt" else [x for x in d if x != 0]
            plus = sum(r for r, x in zip(rankdata([abs(x) for x in kept]), kept) if x > 0)
            file.write(f"{name},0,{zeros},{plus!r},{result.pvalue!r},{listed(d)}\n")
