"""Which claims are judged by one process: those that share results, as far as no process waits for the others.

The fewer processes there are, the less sharing costs: the bounds are shares of what one process has to do.
"""

from collections.abc import Mapping, Sequence

from verification.paper.claims.claim import Claim, seconds

MANY = 16  # processes among which claims should divide evenly, where their number is not known
GROUP = 0.4  # of a process's share: the largest group, unless ...
KEPT = 0.3  # ... so much of a group's seconds is saved by staying together
SMALL, HANDFUL = 0.01, 0.12  # groups of so little go in handfuls, those of one module of judges together


def sharing(claims: Sequence[Claim], jobs: int = MANY) -> list[list[Claim]]:
    """The claims in groups that share results, each in the order given, for so many processes.

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
    """Those groups, the dearest first; what is small goes in handfuls, each of one module of judges."""
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
    """Each group once."""
    found: dict[int, list[Claim]] = {}
    for claim in claims:
        found.setdefault(id(group[claim.id]), []).append(claim)
    return list(found.values())
