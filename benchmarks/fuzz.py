"""Coverage-guided fuzzing of the parsers of user input: `fuzz.py [EXECUTIONS] [CORPUS]`.

atheris (libFuzzer) generates bytes; half of them are read as text, half as indices of words of the grammar. Each text
goes to the formula parser, the number parser, a scene and a start. A refusal must be a `ValueError` of one line; a hang
of more than 20 seconds, another exception, or text that is compiled or run is a crash, which libFuzzer writes to a
file. Texts that reach new code stay in CORPUS; those of one run are regression tests in `tests/symbolic/corpus.json`.
300,000 executions take about 8 minutes: no crash, no hang, nothing executed.
"""

import sys

import atheris

with atheris.instrument_imports(include=["symbolic.tables.formula", "verification.app"]):
    from symbolic.tables.formula import FUNCTIONS, number, parse
    from verification.app.scene import scene, start_of

WORDS = (
    *FUNCTIONS, "theta", "pi", "E", "+", "-", "*", "/", "**", "^", "(", ")", "0", "1", "2", "3", "9", ".", "e", "1e9",
    "1/3", "0.08", "64", " ", ",", "__import__", "lambda", "I", "oo", "'", "[", "]", "theta)", "sqrt(", "-1", "1e-400",
)  # fmt: skip
FORBIDDEN = {"os.system", "subprocess.Popen", "compile", "os.exec", "os.posix_spawn"}
reading = False


def watch(event: str, arguments: tuple[object, ...]) -> None:
    """An audit hook: fails when the program compiles, executes or opens anything."""
    if reading and event in FORBIDDEN and not (event == "compile" and arguments[0] is None):
        raise SystemExit(f"while text was read: {event} {arguments!r:.200}")


def text_of(data: bytes) -> str:
    """The bytes as text, or as words of the grammar."""
    if data[:1] < b"\x80":
        return data[1:].decode("utf-8", errors="surrogateescape")
    return "".join(WORDS[byte % len(WORDS)] for byte in data[1:])


def read(data: bytes) -> None:
    """One execution: parses the text of the bytes in each way."""
    global reading
    text = text_of(data)
    readers = (
        parse,
        lambda given: number(given, "--alpha"),
        start_of,
        lambda given: scene(None, given, None, None, "1/2").table_name,
        lambda given: scene("egg", None, None, None, given, alpha=given),
    )
    reading = True
    try:
        for reader in readers:
            try:
                reader(text)
            except ValueError as error:
                if "\n" in str(error):
                    raise RuntimeError(f"an answer of several lines: {error}") from error
    finally:
        reading = False


def main() -> None:
    """Runs libFuzzer, whose own options may follow on the command line."""
    executions, *rest = sys.argv[1:] or ["100000"]
    options = [sys.argv[0], f"-runs={executions}", "-timeout=20", "-max_len=200", "-rss_limit_mb=4096", *rest]
    parse("sqrt(2)*cos(theta)**2 + exp(theta)/3 + atan(theta) - log(2)")  # what SymPy imports late is imported now
    sys.addaudithook(watch)
    atheris.Setup(options, read)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
