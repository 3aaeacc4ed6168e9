"""The division of claims among processes: claims that share results stay together, and the load is balanced.

A group may take at most a given part of the time of one process. With fewer processes that time is longer, so the
groups may be larger.
"""

from collections.abc import Mapping, Sequence

from verification.paper.claims.claim import Claim, seconds

MANY = 16  # the assumed number of processes, where it is not known
GROUP = 0.4  # the largest group, relative to a process's work, unless ...
KEPT = 0.3  # ... staying together saves at least this part of a group's time
SMALL, HANDFUL = 0.01, 0.12  # groups below SMALL are bundled up to HANDFUL, by module of judges


def sharing(claims: Sequence[Claim], jobs: int = MANY) -> list[list[Claim]]:
    """The claims grouped so that those which share results are together, for `jobs` processes.

    >>> from verification.paper.report.report import catalogue
    >>> [len(group) for group in sharing(catalogue()[:3])]
    [1, 1, 1]
    """
    share = seconds(claims) / jobs
    group = {claim.id: [claim] for claim in claims}
    spared = [(spared, claim.id, other) for claim in claims for other, spared in claim.spares if other in group]
    for saved, first, other in sorted(spared, reverse=True):
        both = group[first] if group[first] is group[other] else group[first] + group[other]
        if seconds(both) <= max(GROUP * share, saved / KEPT):
            group |= {claim.id: both for claim in both}
    return _listed(group, claims)


def shared_out(claims: Sequence[Claim], jobs: int = MANY) -> list[list[Claim]]:
    """The groups of `sharing`, with small groups of one module joined; the most expensive group comes first."""
    share = seconds(claims) / jobs
    group = {claim.id: own for own in sharing(claims, jobs) for claim in own}
    handful: dict[str, list[Claim]] = {}
    for claim in claims:
        own, begun = group[claim.id], handful.get(claim.home, [])
        if own is begun or seconds(own) > SMALL * share:
            continue
        handful[claim.home] = both = own if seconds(begun + own) > HANDFUL * share else begun + own
        group |= {each.id: both for each in both}
    return sorted(_listed(group, claims), key=seconds, reverse=True)


def _listed(group: Mapping[str, list[Claim]], claims: Sequence[Claim]) -> list[list[Claim]]:
    """The different groups, with their claims in the given order."""
    found: dict[int, list[Claim]] = {}
    for claim in claims:
        found.setdefault(id(group[claim.id]), []).append(claim)
    return list(found.values())
