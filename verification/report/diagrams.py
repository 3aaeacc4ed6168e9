"""The work-precision diagrams of the report, from what `pinball work --json FILE` measured."""

import json
from pathlib import Path
from typing import Any

from verification.report.page import Picture

WANTED = "accepted: what `pinball work --json FILE` writes"


def diagrams(path: Path) -> list[Picture]:
    """A picture for each question in the file, with its machine in the footer; `ValueError` when it is no such file."""
    from verification.work.figure import drawn, image
    from verification.work.row import Row

    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        questions = _listed(document["questions"])
        rows = [Row.from_dict(each) for each in document["rows"]]
        known = dict(document["machine"])
        titles = [(each["name"], each["title"], each["answers"], each["unit"]) for each in questions]
    except OSError as error:
        raise ValueError(f"--work {str(path)!r} cannot be read ({error.strerror}); {WANTED}") from None
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"--work {str(path)!r} is no such file ({type(error).__name__}: {error}); {WANTED}") from None
    found = []
    for name, title, answers, unit in titles:
        figure = drawn(title, unit, [row for row in rows if row.question == name], known)
        found.append(Picture(f"work-{name}", f"{title}: {answers}.", "", image(figure, "png")))
    return found


def _listed(questions: Any) -> list[dict[str, str]]:
    return list(questions.values()) if isinstance(questions, dict) else list(questions)
