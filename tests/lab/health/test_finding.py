"""What a report says first, and what it says of a fault."""

from voltcam_lab.health import Determination, Finding, Health

FOUND = (
    Finding("a", "good", "is well", {}),
    Finding("b", "limits", "is short", {}),
    Finding("c", "fatal", "is gone", {}),
)


def test_the_verdict_comes_first_and_what_is_worst_next() -> None:
    lines = Health(FOUND).text().splitlines()
    assert lines[0] == "This recording cannot be used: is gone"
    assert [line.split()[0] for line in lines[1:]] == ["[X]", "[!]", "[ok]"]


def test_what_is_usable_says_with_how_many_reservations() -> None:
    answer = Determination(("k1", "k2"), "in part", "their ratio", {})
    lines = Health(FOUND[:2], (answer,)).text().splitlines()
    assert lines[0] == "This recording can be used, with 1 reservations."
    assert lines[-1] == "  in part k1, k2: their ratio"
    assert Health(FOUND[:1]).text().startswith("This recording can be used.")
