"""`docs/numerics.md` equals the text generated from its sources, so that no number is edited by hand."""

from verification.measure.work.bench import module

DOSSIER = module("dossier")


def test_the_dossier_is_made_from_the_measurements_that_are_committed():
    assert DOSSIER.PAGE.read_text() == DOSSIER.page()
