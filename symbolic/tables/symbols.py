"""The paper's letters, each with the assumptions the paper makes.

One object per letter: two symbols of the same name and different assumptions are different to
SymPy, so everything in the package takes its letters from here.
"""

from sympy import Symbol

theta = Symbol("theta", real=True)  # boundary parameter; the polar angle for polar tables
s = Symbol("s", real=True)  # arc length, counterclockwise
phi = Symbol("phi", real=True)  # exit angle from the inward normal, positive towards the tangent
eta = Symbol("eta", real=True)  # incidence angle; the elastic law is phi = -eta
lam = Symbol("lam", nonnegative=True)  # contraction of the angle, lambda in the paper
t = Symbol("t", positive=True)  # length of a flight

a = Symbol("a", positive=True)  # half the major axis of the ellipse
alpha = Symbol("alpha", nonnegative=True)  # shape of the egg

K0 = Symbol("K0", real=True)  # curvature where a flight leaves, negative when focusing
K1 = Symbol("K1", real=True)  # curvature where it lands
cos_phi0 = Symbol("cos_phi0", positive=True)  # cosine of the exit angle where a flight leaves
cos_eta1 = Symbol("cos_eta1", positive=True)  # cosine of the incidence angle where it lands
