"""The map in float64: kernels generated from the exact tables, at the speed of the machine.

A table argument is one of `symbolic.tables`, a scene, a map, or a name; `lam` and the numbers of its shape are
keywords. A float means the decimal it shows: `0.08` is 2/25. For other numbers write text such as `"1/3"`.

The map
    PinballMap            step, orbit, derivative and exponents of particles, given as arrays

Questions; their results have `.plot()`
    attractors            the sets on which random orbits end, each with its share of the starts
    basins                the attractor that each start of a grid over phase space reaches
    exponents             both Lyapunov exponents of each attractor, with error bars
    bifurcation_diagram   the places of orbits after a long time, against a parameter
    parameter_space       chaos and periods over a shape and the contraction

Starts
    interior_starts       random particles as in the paper's appendix
    phase_starts          random particles, uniform in arc length and in sin(phi)
    phase_grid            a particle in each cell of a grid over phase space

Results
    Orbit                 bounces, with `to_xarray`, `to_pandas` and `plot`
    Exponents             finite-time Lyapunov exponents of particles, with standard errors
    Slap                  iterates of the slap map
    Attractors            result of `attractors`, a sequence of `Attractor`
    Attractor             an attractor: its kind, points, exponents and share
    LyapunovExponents     result of `exponents`
    GridResult            result of `basins` and of diagrams, arrays by name
    Starts                random particles, and the points they came from
    Status                outcomes of a flight, such as `GRAZING`

Modules are imported at their first use: `import numeric` alone loads neither NumPy nor SymPy nor LLVM.

>>> from numeric import PinballMap
>>> step = PinballMap("circle", lam=0.5).step(theta=0.0, phi=0.5)
>>> round(float(step.theta), 12), round(float(step.phi), 12)
(2.14159265359, 0.25)
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
