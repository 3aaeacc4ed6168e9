"""`docs/numerics.md` and `docs/mutation.md` are what their sources say: nobody edits a number there by hand."""

from verification.measure.work.bench import module

DOSSIER, MUTANTS = module("dossier"), module("mutation_page")


def test_the_dossier_is_made_from_the_measurements_that_are_committed():
    assert DOSSIER.PAGE.read_text() == DOSSIER.page()


def test_a_sentence_on_each_storeys_mutants_is_taken_over():
    text = "# Page\n\n`symbolic`: 9 of 10.\n\n`numeric`: 8 of 10.\n\n| `symbolic/expressions/signs.py` | 1 |\n"

    assert DOSSIER.mutation(text) == "`symbolic`: 9 of 10.\n\n`numeric`: 8 of 10."


def test_the_page_on_mutants_is_made_from_the_record_and_every_survivor_has_its_reason():
    page, record = MUTANTS.PAGE.read_text(), MUTANTS.known()

    assert page == MUTANTS.page(record)
    for path, entry in record["modules"].items():
        assert MUTANTS.explained(path, entry["alive"]) == MUTANTS.survived(entry), path


def test_a_reason_speaks_of_a_module_that_is_there_and_of_no_more_survivors_than_were_found():
    alive = {
        (path, name): found for path, e in MUTANTS.known()["modules"].items() for name, found in e["alive"].items()
    }

    assert all((MUTANTS.ROOT / path).is_file() for path, _ in MUTANTS.given())
    assert MUTANTS.given() == alive
