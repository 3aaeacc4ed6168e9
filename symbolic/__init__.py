"""What is the mathematics? Exact tables and scenes, and the formulas that SymPy derives from them.

A table argument is one of `tables`, a scene, a map, or the name of one of the paper's tables. All numbers are exact:
text such as `"2/25"`, `"0.08"` or `"sqrt(2)"`, integers and fractions. A float is refused, since it is not exactly the
decimal that it shows.

Tables
    tables              the paper's tables, a gallery, and `polar`, `parametric`, `piecewise` for one's own
    Scene               a table with its shape, reflection law and contraction; one line of text, `load` and `save`
    Law                 a reflection law: the exit angle as a formula in the incidence angle

Derivations
    curvature           signed curvature along the boundary
    arc_length          arc length along the boundary, in closed form
    perimeter           length of the boundary
    area                enclosed area
    derivative_matrix   d(s1, phi1)/d(s0, phi0) of one flight and one reflection
    slap_map            the one-dimensional map at lam = 0, and its derivative
    double_normals      cycles of period 2 along the axes of symmetry
    monodromy           the derivative matrix of the map around a cycle
    multipliers         its eigenvalues
    thresholds          contractions at which a double normal doubles its period or becomes a focus
    generate            code of a formula for NumPy, mpmath or balls, or as text

Results
    Cycle               a cycle with its bounces
    SlapMap             result of `slap_map`

Letters
    theta               boundary parameter; the polar angle of polar tables
    theta0              boundary parameter at the start of a flight
    theta1              boundary parameter at its landing
    phi                 exit angle
    eta                 incidence angle
    lam                 contraction
    a                   half the major axis of the ellipse
    alpha               shape of the egg

Letters are real symbols of SymPy, and another symbol of the same name, or the text "theta", is not one of them: put
values in for the letters above. A letter of one's own is found in `table.shapes`, and `table.at` gives it a value.

>>> from symbolic import curvature, tables, theta
>>> curvature("circle")
-1
>>> pea = tables.polar("1 + b*cos(2*theta)", b="0:1/5")
>>> curvature(pea).subs(theta, 0)
(-5*b**2 - 6*b - 1)/(b**2 + 2*b + 1)**(3/2)
>>> curvature(pea.at(b="1/10")).subs(theta, 0), curvature(pea).subs({theta: 0, pea.shapes[0].symbol: "1/10"})
(-150/121, -150/121)
"""

import os

import lazy_loader

# Results that SymPy keeps of each of its functions: with its own 1,000 the derivations here take a quarter longer.
os.environ.setdefault("SYMPY_CACHE_SIZE", "20000")

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
