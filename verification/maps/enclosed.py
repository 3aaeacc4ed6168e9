"""The map in balls: a landing is enclosed by Newton's step and proved to be the first hit, or not given at all.

A float64 kernel, or mpmath where that fails, guesses a landing. Newton's method sharpens it; an interval
Newton step then shows that near it every ball of the start lands exactly once; and the boundary is covered
to show that no such flight meets it before (`verification.maps.first_hit`), whatever the shape of the table.
What is proved rests on the balls alone, and not on where the guess came from.

So an enclosed orbit is proved bounce by bounce, for every start in the ball before. Where a landing cannot be proved
the orbit ends with the status `unproved`. How an orbit ends (a join, a cusp, a tangency) is what mpmath finds, and is
not proved. Orbits in mpmath are here as well, to a number of digits, for comparison.
"""

from collections.abc import Callable, Iterator
from enum import Enum
from fractions import Fraction
from typing import Any

from flint import acb, arb, fmpq

from numeric import PinballMap
from numeric.backends.scalars import ScalarBackend
from numeric.pinball.states import STATUSES
from verification.arithmetic.balls import as_ball, bits_of, enclose, working
from verification.arithmetic.iteration import Stop, Vector, iterated
from verification.maps.exact import Bounce, ExactMap, closed_length
from verification.maps.first_hit import BITS, Boundary, Frame, free

GUESSED = 40  # digits of a guess by mpmath
Flight = Callable[[arb], tuple[arb, arb]]  # by the place on the wall: 0 where the ray meets it, and its slope there
NEWTON = Stop(small=1e-6, steps=40)  # the digits of a guess double from 15 on
MARGIN = 2.0**-20  # how far a ball's angle must stay within what the kernels take


class Refusal(Enum):
    """Why a bounce is not given."""

    WIDE = "the start is not known well enough; ask for more digits"
    UNPROVED = "no proof that the flight meets nothing before it lands"


class Balls(ScalarBackend[Any]):
    """What a program needs of ball arithmetic: constants, roots, sine and cosine."""

    def __init__(self) -> None:
        """No context: everything that a program needs is below."""

    def q(self, p: int, n: int) -> arb:
        """`p/n`, enclosed."""
        return arb(fmpq(p, n))

    @property
    def pi(self) -> arb:
        """Pi, enclosed."""
        return arb.pi()

    def sqrt(self, x: Any) -> Any:
        """The square root."""
        return x.sqrt()

    def sin(self, x: Any) -> Any:
        """The sine."""
        return x.sin()

    def cos(self, x: Any) -> Any:
        """The cosine."""
        return x.cos()

    def exp(self, x: Any) -> Any:
        """The exponential."""
        return x.exp()

    def log(self, x: Any) -> Any:
        """The natural logarithm."""
        return x.log()

    def atan(self, x: Any) -> Any:
        """The arc tangent."""
        return x.atan()

    def sinh(self, x: Any) -> Any:
        """The hyperbolic sine."""
        return x.sinh()

    def cosh(self, x: Any) -> Any:
        """The hyperbolic cosine."""
        return x.cosh()

    def tanh(self, x: Any) -> Any:
        """The hyperbolic tangent."""
        return x.tanh()

    def root(self, x: Any, n: int) -> Any:
        """The positive `n`-th root."""
        return x.root(n)


class EnclosedMap:
    """The map of a `PinballMap`'s table in balls of `bits` bits.

    >>> from numeric import PinballMap
    >>> ellipse = EnclosedMap(PinballMap("ellipse", a=2, lam=1), 1, bits=100)
    >>> bounce = ellipse.bounce(ellipse.start(Fraction(0), Fraction(0)))
    >>> bounce.x.contains(-2), bounce.x.rad() < 1e-20
    (True, True)
    """

    def __init__(self, map: PinballMap, lam: Any, bits: int) -> None:
        self.map, self.bits, self.ops = map, bits, Balls()
        self.exact = ExactMap(map, GUESSED, lam)
        with working(bits):
            self.lam = number(lam, bits)
            self.shape = [number(value, bits) for value in map.exact_shape]
            self.ends = [tuple(part.ends(self.ops, *self.shape)) for part in map.ir.parts]
        self.parts = [part.curve for part in map.ir.parts]
        self.boundary = Boundary([self._placed(i) for i in range(len(self.parts))], self.ends)

    def start(self, theta: Any, phi: Any, component: int = 0) -> Bounce:
        """All bounces whose parameter and exit angle lie in these, which may be exact numbers."""
        with working(self.bits):
            theta, phi = number(theta, self.bits), number(phi, self.bits)
            x, y, dx, dy, _, _ = self.curve(component, theta)
            speed = (dx * dx + dy * dy).sqrt()
            c, s = phi.cos(), phi.sin()
            v = (s * dx - c * dy) / speed, (s * dy + c * dx) / speed
            return Bounce(component, theta, phi, v, x, y)

    def bounce(self, here: Bounce) -> Bounce | Refusal:
        """One flight and one reflection, proved; a particle that stops by a named outcome has that outcome's `code`.

        An outcome is what mpmath finds for the middle of `here`, and is not proved.
        """
        refusal = Refusal.WIDE
        for guess in self._guesses(here):
            if guess.code:
                return guess
            with working(self.bits):
                landed = self._landed(here, guess)
            if landed is None:
                continue
            with working(BITS):
                ends = (here.component, here.theta), (landed.component, landed.theta)
                if free(self.boundary, *ends):
                    return landed
            refusal = Refusal.UNPROVED
        return refusal

    def orbit(self, here: Bounce, bounces: int) -> Iterator[Bounce]:
        """So many landings, each proved to be the first hit; fewer where one is not proved, or the particle stops."""
        for _ in range(bounces):
            landed = self.bounce(here)
            if isinstance(landed, Refusal) or landed.code:
                return
            yield landed
            here = landed

    def curve(self, component: int, theta: arb) -> list[arb]:
        """Point, velocity and acceleration."""
        return self.parts[component](self.ops, theta, *self.shape)

    def _exit(self, eta: arb, component: int, theta: arb) -> arb:
        """The exit angle, enclosed."""
        formula = self.exact.formula
        if formula is None:
            return -self.lam * eta
        place: tuple[arb, ...] = (theta, self.length(component, theta)) if formula.measured else (theta,)
        found: arb = formula.exit(self.ops, eta, self.lam, *place)[0]
        return found

    def length(self, component: int, theta: arb, digits: int = 0) -> Any:
        """The paper's arc length, by rigorous integration of the speed where there is no closed form; of all digits."""
        closed = closed_length(self.map, self.ops, self.shape, component, theta)
        if closed is not None or len(self.parts) > 1:
            return closed
        (zero,), middle = self.map.ir.origin[1](self.ops, *self.shape), arb(theta.mid())
        _, _, dx, dy, _, _ = self.curve(component, theta)
        found = _integrated(self, component, zero, middle, digits or int(self.bits / 3.33))
        return found + (dx * dx + dy * dy).sqrt() * (theta - middle)

    def _placed(self, component: int) -> Any:
        def place(theta: arb) -> Frame:
            return tuple(self.curve(component, theta)[:4])

        return place

    def _guesses(self, here: Bounce) -> Iterator[Bounce]:
        """The landing of the middle: by a kernel if it finds one, then by mpmath."""
        theta, phi = float(here.theta.mid()), float(here.phi.mid())
        low, high = self.map.states.ends[here.component]
        if low <= theta <= high and abs(phi) < 1.5707 and abs(abs(theta) - 3.141592653589793) > MARGIN:
            step = self.map.step(theta, phi, here.component)
            if not step.code:
                yield Bounce(int(step.component), arb(float(step.theta)), None, (None, None), None, None)
        exact = self.exact
        guess = exact.bounce(exact.start(exact.middle(here.theta), exact.middle(here.phi), here.component))
        yield Bounce(guess.component, as_ball(guess.theta), None, (None, None), None, None, code=guess.code)

    @staticmethod
    def _polished(flight: Flight, near: arb) -> arb:
        """A guess of the landing that is sharper, by Newton's method, which proves nothing."""

        def correction(at: Vector) -> Vector:
            value, slope = (each.mid() for each in flight(*at))
            return [(value / slope).mid()]

        middle: arb = iterated(correction, [near], NEWTON, kept=arb.mid).x[0]
        return middle

    def _reach(self, step: arb, middle: arb) -> arb:
        """How far about a guess a landing is looked for: an interval Newton step closes there, or nothing is said."""
        return abs(step) * 4 + (abs(middle) + 1) * arb(2) ** (4 - self.bits)

    def _landed(self, here: Bounce, guess: Bounce) -> Bounce | None:
        """The enclosed landing near a guess, or None when Newton's step does not close."""
        vx, vy = here.v

        def flight(theta: arb) -> tuple[arb, arb]:
            x, y, dx, dy, _, _ = self.curve(guess.component, theta)
            return vx * (y - here.y) - vy * (x - here.x), vx * dy - vy * dx

        middle = self._polished(flight, guess.theta)
        value, slope = flight(middle)
        box = arb(middle, self._reach(value / slope, middle).upper())  # without end where the slope may be 0
        newton = middle - value / flight(box)[1]
        low, high = self.ends[guess.component]
        if not box.contains_interior(newton) or not (len(self.ends) == 1 or low < newton < high):
            return None
        x, y, dx, dy, _, _ = self.curve(guess.component, newton)
        if not vx * (x - here.x) + vy * (y - here.y) > 0:
            return None
        eta = -(arb.atan2(vx * dx + vy * dy, vx * dy - vy * dx))
        following = self.start(newton, self._exit(eta, guess.component, newton), guess.component)
        return Bounce(guess.component, newton, following.phi, following.v, x, y, eta)


def number(value: Any, bits: int = 0) -> arb:
    """A number, exact or float or a ball, as a ball."""
    if isinstance(value, arb):
        return value
    if isinstance(value, Fraction):
        return arb(fmpq(value.numerator, value.denominator))
    if isinstance(value, int | float):
        return arb(value)
    return enclose(value, digits=int(bits / 3.3219) + 2).real


TRIES = 8  # doublings of the precision before giving up
Step = Callable[[str], None]
Start = tuple[Any, Any, int]  # theta and phi, exactly, and the component


def in_multiprecision(
    map: PinballMap, lam: Any, start: Start, bounces: int, digits: int, step: Step
) -> list[dict[str, Any]]:
    """The orbit computed with mpmath; rounding errors grow as the orbit's own instability makes them."""
    exact = ExactMap(map, digits, lam)
    mp = exact.context
    theta, phi, component = start
    here = exact.start(exact.exactly(theta) - 2 * _turns(map, start) * mp.pi, exact.exactly(phi), component)
    names = [part.name for part in map.ir.parts]
    entries: list[dict[str, Any]] = []
    for i in range(bounces + 1):
        if i:
            following = exact.bounce(here)
            if following.code:
                entries.append(entries[-1] | {"eta": None, "status": STATUSES[following.code].name.lower()})
                break
            here = following
            step(str(i))
        numbers = (here.theta, exact.length(here.component, here.theta), here.x, here.y, here.eta, here.phi)
        texts = [None if x is None else mp.nstr(x, digits) for x in numbers]
        entries.append(_entry(names[here.component], texts))
    return entries


def in_balls(map: PinballMap, lam: Any, start: Start, bounces: int, digits: int, step: Step) -> list[dict[str, Any]]:
    """The orbit enclosed to `digits` digits, which count from the point where a number is below one."""
    bits = bits_of(digits, 64 + 4 * bounces)
    for _ in range(TRIES):
        found = _attempt(map, lam, start, bounces, digits, bits, step)
        if found is not None:
            return found
        bits *= 2
    raise ValueError(f"--digits = {digits}: {bits // 2} bits do not enclose {bounces} bounces; ask for fewer of either")


def _attempt(
    map: PinballMap, lam: Any, start: Start, bounces: int, digits: int, bits: int, step: Step
) -> list[dict[str, Any]] | None:
    enclosed = EnclosedMap(map, lam, bits)
    names = [part.name for part in map.ir.parts]
    entries: list[dict[str, Any]] = []
    with working(bits):
        theta = number(start[0], bits) - 2 * _turns(map, start) * arb.pi()
    here = enclosed.start(theta, *start[1:])
    for i in range(bounces + 1):
        if i:
            following = enclosed.bounce(here)
            if following is Refusal.WIDE:
                return None
            if isinstance(following, Refusal) or following.code:
                status = "unproved" if isinstance(following, Refusal) else STATUSES[following.code].name.lower()
                entries.append(entries[-1] | {"eta": None, "status": status})
                break
            here = following
            step(str(i))
        with working(bits):
            s = enclosed.length(here.component, here.theta, digits)
            numbers = (here.theta, s, here.x, here.y, here.eta, here.phi)
            texts = [None if n is None else _text(n, digits) for n in numbers]
        if "" in texts:
            return None
        entries.append(_entry(names[here.component], texts))
    return entries


def _turns(map: PinballMap, start: Start) -> int:
    """The whole turns by which a start on a closed curve lies beyond the range of its parameter: 0 up to its ends."""
    low, high = map.states.ends[start[2]]
    return 0 if len(map.states.ends) > 1 else round((float(start[0]) - (low + high) / 2) / (high - low))


def _text(number: arb, digits: int) -> str:
    """A ball's middle, of whose digits the last is off by one at most; empty when the ball is too wide for `digits`.

    Digits count from the point where a number is below one, and what is below all of them is 0.
    """
    size = max(1.0, float(abs(number.mid())))
    if not number.rad() < arb(10) ** (-digits) * size:
        return ""
    if abs(number) < arb(10) ** -digits:
        return "0"
    known = digits if number.is_exact() else min(digits, int(0.301 * (number.rel_accuracy_bits() - 2)))
    return str(number.mid().str(known, radius=False)) if known > 0 else ""


def perimeter(enclosed: EnclosedMap, digits: int) -> arb:
    """The length of the whole boundary, by rigorous integration of the speed.

    >>> circle = EnclosedMap(PinballMap("circle"), 1, bits=100)
    >>> bool(abs(perimeter(circle, 20) - 2 * arb.pi()) < 1e-15)
    True
    """
    parts = (_integrated(enclosed, i, low, high, digits) for i, (low, high) in enumerate(enclosed.ends))
    with working(bits_of(digits, 40)):
        return sum(parts, arb(0))


def _integrated(enclosed: EnclosedMap, component: int, low: arb, high: arb, digits: int) -> arb:
    """The length of a component between two parameters."""
    boxed = [acb(x) for x in enclosed.shape]

    def speed(z: acb, analytic: bool) -> Any:
        _, _, dx, dy, _, _ = enclosed.parts[component](_Complex(), z, *boxed)
        return (dx * dx + dy * dy).sqrt(analytic=analytic)

    with working(bits_of(digits, 40)):
        return acb.integral(speed, acb(low), acb(high)).real


class _Complex(Balls):
    """The same on complex balls, with no value where a cut may pass through."""

    def sqrt(self, x: Any) -> Any:
        return x.sqrt(analytic=True)

    def log(self, x: Any) -> Any:
        return x.log(analytic=True)

    def atan(self, x: Any) -> Any:
        return x.atan() if abs(x.imag) < 1 else acb("nan")

    def root(self, x: Any, n: int) -> Any:
        return (x.log(analytic=True) / n).exp()

    def q(self, p: int, n: int) -> Any:
        return acb(fmpq(p, n))

    @property
    def pi(self) -> Any:
        return acb.pi()


def _entry(name: str, texts: list[str | None]) -> dict[str, Any]:
    theta, s, x, y, eta, phi = texts
    return {"component": name, "theta": theta, "s": s, "x": x, "y": y, "eta": eta, "phi": phi, "status": "regular"}
