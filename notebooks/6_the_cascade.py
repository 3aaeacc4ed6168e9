# # 6. The cascade and delta
#
# At $\alpha = 0.08$ the stable period-4 orbit of the egg doubles again and again. The paper gives $\lambda_3$ to
# $\lambda_6$ from plots (section 6.6); here each is certified, and the end of the cascade is extrapolated with an
# error estimate.

# +
from itertools import pairwise

from mpmath import mp, mpf, nstr

from numeric import bifurcation_diagram
from verification import locate

# -

# ## Certified doublings
#
# `doubling` with $n$ is the change from period $2^{n-1}$ to $2^n$. Each carries the whole checklist of a period
# doubling: a cycle in the box, unique, admissible, of minimal period, one simple multiplier $-1$, crossed with
# non-zero speed, and a normal-form coefficient of known sign.

doublings = {n: locate("doubling", 50, alpha="2/25", n=n) for n in range(3, 9)}
doublings[3]

printed = {3: "0.372", 4: "0.389", 5: "0.393", 6: "0.3935"}
for n, each in doublings.items():
    print(n, each.value[:22], "certified" if each.certified else "not certified", "| printed", printed.get(n, "-"))

# $\lambda_3$ is 0.371 to three digits, not 0.372, and $\lambda_6$ is 0.3933, not 0.3935. At each doubling a stable
# cycle is born:

doublings[8].notes["kind"]

# Where random balls are after a long time, as a density; the red lines are the doublings:

diagram = bifurcation_diagram("egg", alpha="2/25", lam=("0.35", "0.4"), bounces=1000).plot()
for each in doublings.values():
    diagram.axes[0].axvline(float(each.value), color="red", linewidth=0.8)
diagram

# ## The end of the cascade
#
# The gaps between doublings shrink by a ratio that tends to Feigenbaum's $\delta$ [Feigenbaum1979]. Two extrapolations
# of a sequence share nothing but its terms. Aitken's process removes one geometric term at a time, and is repeated:


# +
def aitken(terms):
    """The limit by Aitken's process, repeated while three terms remain."""
    while len(terms) >= 3:
        triples = zip(terms, terms[1:], terms[2:], strict=False)
        terms = [z - (z - y) ** 2 / (z - 2 * y + x) for x, y, z in triples]
    return terms[-1]


# -

# Wynn's epsilon algorithm builds a table, $\varepsilon_{k+1}^{(i)} = \varepsilon_{k-1}^{(i+1)} +
# 1/(\varepsilon_k^{(i+1)} - \varepsilon_k^{(i)})$, whose even columns approach the limit:


# +
def wynn(terms):
    """The limit by Wynn's epsilon algorithm: the last entry of the last even column."""
    before, column, limit = [0] * (len(terms) + 1), terms, terms[-1]
    for order in range(1, len(terms)):
        steps = [y - x for x, y in pairwise(column)]
        before, column = column, [before[i + 1] + 1 / step for i, step in enumerate(steps)]
        limit = column[-1] if order % 2 == 0 else limit
    return limit


# -

# The largest difference between extrapolations is the error estimate. The first line is $\delta$. For the second,
# $\lambda_\infty$, Wynn's algorithm also runs on the sequence from which the term of ratio $1/\delta$ has been removed.
# These two numbers are *estimated*, not certified.

# +
mp.dps = 60
delta = mpf("4.669201609102990671853203820466")
values = [mpf(each.value) for each in doublings.values()]
gaps = [y - x for x, y in pairwise(values)]
ratios = [x / y for x, y in pairwise(gaps)]
ratio = wynn(ratios)
ratio_error = max(abs(ratio - other) for other in (aitken(ratios), wynn(ratios[:-1])))
print("delta     =", nstr(ratio, 8), "+-", nstr(ratio_error, 2))

end = wynn(values)
end_error = abs(end - wynn([(delta * y - x) / (delta - 1) for x, y in pairwise(values)]))
print("lambda_oo =", nstr(end, 12), "+-", nstr(end_error, 2))
# -

# Work grows linearly with the period, because the chord system is cyclic and tridiagonal and is never written as a
# dense matrix; the cascade goes on to period $2^{15}$.

# ## A check that can fail
#
# The first ratios of the gaps approach $\delta = 4.669201609\ldots$ [Feigenbaum1979].

print([nstr(x, 10) for x in ratios])
assert all(each.certified for each in doublings.values())
assert all(each.notes["kind"].startswith("supercritical") for each in doublings.values())
assert abs(ratios[1] - delta) < 0.15
assert abs(ratio - delta) < 3 * ratio_error < 1e-2
assert values[-1] < end < values[-1] + gaps[-1]
assert end_error < 1e-7
