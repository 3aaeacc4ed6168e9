"""Starts of the contacts in windows of periodic attractors and small families, at `alpha = 0.08`.

These contacts end a family, join its bands, or widen the attractors of the main cascade; `docs/crises.md` explains each
one. The starts were found numerically and refined by `tangency`.
"""

from verification.cycles.recurrence import Closure
from verification.proofs.manifolds.saddle import SaddleCycle
from verification.proofs.manifolds.tangency import Contact


def homoclinic(orbit: SaddleCycle, bounces: int, sign: int, z: float, end: float, parameter: float) -> Contact:
    """A contact of the two manifolds of one saddle."""
    return Contact(orbit, orbit, bounces, sign, z, end, parameter)


WIDENED = SaddleCycle(
    "saddle of period 12 from the fold at 0.36753",
    (0.09755931, 3.631414, 6.293937, 9.245568, 12.65503, 16.08594),
    Closure(-1, (9, 3)),
)
WINDOWS = {
    "family-end-12": homoclinic(
        SaddleCycle(
            "saddle of period 12 from the fold at 0.36753",
            (-0.5576089, 2.102219, 5.072128, 8.459819, 11.85147, 14.54776),
            Closure(-1, (8, 3)),
        ),
        12,
        1,
        -0.0119581218,
        3.88517134,
        0.37568811745482,
    ),
    "family-end-8": homoclinic(
        SaddleCycle(
            "saddle of period 8 from the fold at 0.37326",
            (0.8016613, 4.345161, 7.921223, 10.61693),
            Closure(-1, (7, 3)),
        ),
        8,
        1,
        0.0062893759,
        -19.6898773,
        0.38263562225812,
    ),
    "window-end-12": homoclinic(
        SaddleCycle(
            "saddle of period 12 from the fold at 0.40080",
            (
                -0.0923694,
                2.691104,
                6.315175,
                9.718258,
                12.45732,
                15.23081,
                18.85775,
                22.21659,
                25.02905,
                27.84044,
                31.46964,
                34.91534,
            ),
            Closure(1, (18, 3)),
        ),
        48,
        1,
        0.00155000015,
        -3.08122107e-07,
        0.40239276667437,
    ),
    "window-end-15": homoclinic(
        SaddleCycle(
            "saddle of period 15 from the fold at 0.44693",
            (-2.278344, 0.7208317, 4.361593, 8.041554, 10.86863),
            Closure(1, (8, 3)),
        ),
        10,
        1,
        0.00581672864,
        0.0380764878,
        0.44786877669388,
    ),
    "window-end-9": homoclinic(
        SaddleCycle(
            "cycle of period 9 on the boundary of the basin",
            (-2.292046, 0.2097274, 3.429299, 6.069922, 8.571134, 11.76231, 14.45184, 16.98282, 20.24812),
            Closure(1, (12, 3)),
        ),
        24,
        1,
        -0.00477754589,
        -8.60261399e-06,
        0.50540075653662,
    ),
    "window-end-14": homoclinic(
        SaddleCycle(
            "saddle of period 14 from the fold at 0.56500",
            (2.254813, 5.331168, 8.223047, 10.9103, 14.47918, 17.48615, 21.14934),
            Closure(-1, (13, 3)),
        ),
        14,
        1,
        0.00105284676,
        -0.0358076417,
        0.56503314127141,
    ),
    "window-end-18": homoclinic(
        SaddleCycle(
            "saddle of period 18 from the fold at 0.64099",
            (0.0931774, 3.731487, 6.464468, 9.738167, 12.34063, 14.70088, 17.40979, 20.97372, 24.4557),
            Closure(-1, (13, 3)),
        ),
        18,
        1,
        0.00115315352,
        0.00749274193,
        0.64103133488259,
    ),
    "family-merging-12": homoclinic(
        SaddleCycle(
            "symmetric cycle of period 12 born at 0.36753",
            (-0.5478452, 2.111142, 5.098686, 8.446527, 11.79871, 14.53786),
            Closure(-1, (8, 3)),
        ),
        24,
        1,
        -0.00854539538,
        -0.00127840799,
        0.37410329567938,
    ),
    "family-merging-8": homoclinic(
        SaddleCycle(
            "symmetric cycle of period 8 born at 0.37326",
            (0.7205278, 4.340274, 7.935613, 10.64481),
            Closure(-1, (7, 3)),
        ),
        16,
        1,
        0.00768453543,
        0.0460355151,
        0.38107431694566,
    ),
    "window-merging-12": homoclinic(
        SaddleCycle(
            "cycle of period 12 born at 0.40080",
            (
                -0.0894974,
                2.69771,
                6.320959,
                9.734416,
                12.45937,
                15.23099,
                18.85711,
                22.21419,
                25.02957,
                27.84315,
                31.47205,
                34.92186,
            ),
            Closure(1, (18, 3)),
        ),
        48,
        1,
        -0.0015506072,
        -0.0113704412,
        0.40208039226338,
    ),
    "window-merging-15": homoclinic(
        SaddleCycle(
            "cycle of period 15 born at 0.44693",
            (-2.269106, 0.7479066, 4.366492, 8.044471, 10.87356),
            Closure(1, (8, 3)),
        ),
        15,
        1,
        0.0044596375,
        -0.0158089756,
        0.44770651916565,
    ),
    "window-merging-9": homoclinic(
        SaddleCycle("cycle of period 9 born at 0.49117", (-2.865415, -0.2119222, 2.298062), Closure(1, (4, 3))),
        12,
        1,
        0.0112281789,
        0.0597967116,
        0.50452731276756,
    ),
    "window-merging-14": homoclinic(
        SaddleCycle(
            "symmetric cycle of period 14 born at 0.56500",
            (2.254608, 5.331005, 8.223263, 10.91109, 14.48073, 17.491, 21.15025),
            Closure(-1, (13, 3)),
        ),
        28,
        1,
        0.000794256537,
        7.40499926e-05,
        0.56502707856559,
    ),
    "window-merging-18": homoclinic(
        SaddleCycle(
            "symmetric cycle of period 18 born at 0.64099",
            (0.0935406, 3.732379, 6.46611, 9.743485, 12.3417, 14.70104, 17.40969, 20.97354, 24.45505),
            Closure(-1, (13, 3)),
        ),
        36,
        1,
        0.000868603198,
        3.84418272e-05,
        0.64102472643639,
    ),
    "band-merging-8": homoclinic(
        SaddleCycle(
            "cycle of period 8",
            (0.1046598, 3.610736, 6.26788, 9.182976, 12.67319, 16.15428, 18.80809, 21.67246),
            Closure(1, (12, 3)),
        ),
        32,
        1,
        -0.0082402509,
        0.00421512561,
        0.39441454997418,
    ),
    "band-merging-16": homoclinic(
        SaddleCycle(
            "cycle of period 16",
            (
                0.1024415,
                3.607025,
                6.264525,
                9.173723,
                12.67446,
                16.16142,
                18.81526,
                21.6934,
                25.24081,
                28.74558,
                31.4018,
                34.3191,
                37.80531,
                41.28346,
                43.93746,
                46.79604,
            ),
            Closure(1, (24, 3)),
        ),
        64,
        1,
        -0.00192956283,
        -1.55847023,
        0.39371184930788,
    ),
    "window-end-6": homoclinic(
        SaddleCycle(
            "saddle of period 6 from the fold at 0.41922",
            (-0.07405129, 2.863018, 6.41507, 9.976316, 12.65351, 15.76768),
            Closure(1, (9, 3)),
        ),
        18,
        1,
        0.00211909828,
        -0.0390998807,
        0.42093040233566,
    ),
    "window-end-8": homoclinic(
        SaddleCycle(
            "saddle of period 8 from the fold at 0.39008",
            (1.565194, 4.22992, 7.259888, 10.49862, 13.73159, 16.67711, 19.59012, 23.16111),
            Closure(1, (12, 3)),
        ),
        24,
        1,
        0.00327830088,
        0.000874337288,
        0.39066907817289,
    ),
    "window-end-20": homoclinic(
        SaddleCycle(
            "saddle of period 20 from the fold at 0.41958",
            (-2.653915, 0.004628499, 2.946135, 6.378108, 9.826581, 12.48516, 15.26474, 18.88617, 22.30631, 25.02615),
            Closure(-1, (12, 3)),
        ),
        30,
        -1,
        -0.00290017391,
        0.000978875023,
        0.42043357048402,
    ),
    "interior-crisis-1": homoclinic(
        WIDENED,
        16,
        1,
        0.0029108256289,
        0.0106893897335,
        0.42841918986809,
    ),
    "interior-crisis-1-later": homoclinic(
        WIDENED,
        36,
        1,
        0.0047203997,
        0.0106893905,
        0.4284191907546,
    ),
    "interior-crisis-2": homoclinic(
        SaddleCycle("cycle of 4 bounces and a turn", (-0.07156026, 2.367991, 5.604774, 8.125316), Closure(1, (5, 3))),
        15,
        1,
        0.0010931310,
        -0.0020989784,
        0.6289627706730,
    ),
    "interior-crisis-3": homoclinic(
        SaddleCycle("cycle of period 5", (-0.04810539, 2.369335, 5.583150, 8.101284, 10.31333), Closure(1, (6, 3))),
        19,
        1,
        0.00016865854,
        -0.00024320942,
        0.6534559757881,
    ),
}
