"""`docs/numerics.md` is what its sources say: nobody edits a number there by hand."""

from verification.measure.speed.baselines import module

DOSSIER = module("dossier")


def test_the_dossier_is_made_from_the_measurements_that_are_committed():
    assert DOSSIER.PAGE.read_text() == DOSSIER.page()


def test_a_sentence_on_each_storeys_mutants_is_taken_over():
    text = "# Page\n\n`symbolic`: 9 of 10.\n\n`numeric`: 8 of 10.\n\n| `symbolic/proofs/zero.py` | 1 |\n"

    assert DOSSIER.mutation(text) == "`symbolic`: 9 of 10.\n\n`numeric`: 8 of 10."
