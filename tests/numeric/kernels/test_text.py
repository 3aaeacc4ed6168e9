"""What is counted in a kernel's text, and what is left out of it."""

import numpy as np

from numeric import PinballMap
from numeric.kernels.machine import KernelSpec
from numeric.kernels.text import alive, kernel_text, operations

TEXT = """\
define void @run() {
entry:
  %a = fadd <8 x double> %x, %y
start:
  %b = fmul <8 x double> %x, %y
stretch:
  %c = fmul <8 x double> %x, %y
bounce:
  %d = fadd <8 x double> %x, %y
  %e = fsub <8 x double> %x, %y
  %f = fmul <8 x double> %x, %y
  %g = fdiv <8 x double> %x, %y
  %h = fcmp olt <8 x double> %x, %y
  %i = select <8 x i1> %h, <8 x double> %x, <8 x double> %y
  %j = call <8 x double> @llvm.fma.v8f64(<8 x double> %x, <8 x double> %y, <8 x double> %z)
  %k = call <8 x double> @llvm.sqrt.v8f64(<8 x double> %x)
  %l = call <8 x double> @llvm.fabs.v8f64(<8 x double> %x)
  %m = add i64 %i, 1
  store <8 x double> %d, ptr %p
inside7:
  %n = fdiv <8 x double> %x, %y
after8:
  %o = fadd <8 x double> %x, %y
head9:
  %p = fdiv <8 x double> %x, %y
measured:
  %q = fdiv <8 x double> %x, %y
}
"""


def test_operations_are_those_of_a_bounce_without_rare_branches():
    assert operations(TEXT) == {"fma": 1, "add": 3, "mul": 1, "div": 1, "sqrt": 1, "compare": 1, "select": 1}
    assert set(operations("").values()) == {0}


def test_a_kernel_that_streams_is_done_with_what_it_tells_before_it_returns():
    map = PinballMap("ellipse", lam=0.7, a=2)
    one, other = (
        kernel_text(map.family, map.engine.names, KernelSpec(map.law, told=("phi", "x"), streams=streams))
        for streams in (False, True)
    )

    assert one.count("nontemporal") == one.count("fence") == 0
    assert other.count("align 64, !nontemporal !0") == 2
    assert other.index("fence seq_cst") > other.rindex(
        "ldmxcsr(ptr %mode)" if "ldmxcsr(ptr %mode)" in other else "exit:"
    )


def test_what_a_branch_needs_is_alive_and_what_only_the_dead_need_is_not():
    lines = [
        "head:",
        "  %a = phi i64 [0, %entry], [%b, %head]",
        "  %b = add i64 %a, 1",
        "  %dead = add i64 %only, 1",
        "  %only = add i64 %b, 1",
        "  %c = icmp slt i64 %b, 9",
        "  br i1 %c, label %head, label %exit",
    ]

    assert alive(lines) == [line for line in lines if "dead" not in line and "only" not in line]
    assert alive(["  %x = call i64 @f()", "  call void @g(i64 %y)", "  %y = add i64 1, 2"]) == [
        "  call void @g(i64 %y)",
        "  %y = add i64 1, 2",
    ]


def test_a_ball_that_stops_keeps_its_outcome_and_counts_what_it_loses():
    """From the middle of the cuspless arc: to the upper join, to the lower one, and elsewhere."""
    map = PinballMap("cuspless", lam=0.9)
    aim = np.arctan2(np.sqrt(3) / 4, 2.25)
    own = map.states.enter(np.zeros(3, dtype=int), np.zeros(3), np.array([aim, -aim, 0.3]), map.law)
    rows = map.engine.run(KernelSpec(map.law), own, np.full(3, 0.9), [], 5).rows

    assert rows["code"].tolist() == [1, 1, 0] or rows["code"].tolist() in ([1, 0, 0], [0, 1, 0])
    assert rows["lost"].tolist() == (5 * rows["code"]).tolist()


def test_a_kernel_has_the_lanes_of_its_family_unless_told_otherwise():
    map = PinballMap("cardioid", lam=0.5)
    asked = map.family, map.engine.names, KernelSpec("pinball")

    assert kernel_text(*asked) == kernel_text(*asked, map.family.width) != kernel_text(*asked, 8)


def test_a_tangent_vector_is_looked_at_every_few_bounces_and_without_one_nothing_is():
    map = PinballMap("cardioid", lam=0.5)
    plain, watched = (
        kernel_text(map.family, map.engine.names, KernelSpec("pinball", exponents=asked)) for asked in (False, True)
    )

    assert "%full = add i64 %bounces, 0" in plain
    assert f"%full = add i64 %begun, {map.family.renormalise_every}" in watched
