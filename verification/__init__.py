"""Is it true, how well, at what cost? Questions on a scene, proofs in balls, the judged paper.

A table is given as one of `symbolic.tables`, as a scene, a map, or by its name; `lam` and the numbers of its shape are
keywords, exact as for `Scene`: `"1/10"`, `"0.1"`, `Fraction(1, 10)`. A float is refused, as it is not what it shows.

Cycles and their bifurcations
    find_cycles       the cycles of one period, or up to one, by search
    follow            what becomes of a cycle as a parameter changes: a branch with its events
    bifurcations      folds, doublings and pitchforks over an interval of a parameter, with proofs
    certify           a proof of a cycle, or of an event of a branch, to N digits
    locate            the paper's named values to N certified digits
    check             does a certificate still hold, and does it say what its name says?

All orbits at once
    trapping_region   cells of phase space that the map takes inside themselves, proved
    morse_graph       which attractors and repellers there are, and in what order, proved

Pages
    verify            is each claim of the paper true?
    report            everything about one's own scene on one page
    work_precision    error against run time of a question on one's own scene
    judging           a module: what the judges of a paper of one's own import

Arithmetics and tests
    ExactMap          the map in mpmath, to N digits
    EnclosedMap       the map in balls, each landing proved to be the first hit
    laws              property tests of any table in one line each, such as `laws.jacobian(table)`
    strategies        tables, laws and particles for Hypothesis

Results
    PeriodicOrbits    what `find_cycles` gives, a sequence of `PeriodicOrbit`
    PeriodicOrbit     a cycle with its multipliers
    FollowedOrbit     what `follow` gives: `.folds`, `.flips`, `.plot()`
    BranchEvent       what happens on a branch, and where
    Located           a value in decimals, and what was proved about it
    WorkPrecision     what `work_precision` gives

Nothing is loaded before it is used: neither mpmath nor python-flint, neither SymPy nor NumPy.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
