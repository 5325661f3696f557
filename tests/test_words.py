"""The tree is written in the field's terms: no private words, no unclear phrases, few vague locals."""

import pytest

from tests import words

MAX_VAGUE = 0  # functions of the whole tree that bind a local called found, given, wanted, own or told

# Each returns a changed copy of its argument, as `sorted` does.
CHANGED_COPIES = frozenset(
    [
        "wrapped",
        "slewed",
        "guarded",
        "outlined",
        "abbreviated",
        "augmented",
        "balanced",
        "bracketed",
        "deflated",
        "displaced",
        "elided",
        "equilibrated",
        "escaped",
        "folded",
        "mirrored",
        "numbered",
        "paired",
        "parenthesised",
        "perturbed",
        "prewarped",
        "renamed",
        "renumbered",
        "resampled",
        "rounded",
        "sampled",
        "scaled",
        "simplified",
        "substituted",
        "thinned",
        "truncated",
        "unranged",
        "unrounded",
        "unwarped",
        "weighted",
    ]
)

# These end in -ed for another reason.
QUESTIONS = frozenset(  # they return a truth value
    [
        "is_answered",
        "is_guarded",
        "is_flagged",
        "is_followed",
        "is_listed",
        "is_loaded",
        "is_pipelined",
        "is_resolved",
        "is_saturated",
        "is_unfolded",
        "may_be_mirrored",
        "may_stay_unrounded",
        "passed",
    ]
)
DECORATORS = frozenset({"cached", "checked"})  # as `functools.cached_property`: they describe the decorated function
NOUNS = frozenset({"r_squared", "seed"})  # no participle


def python() -> dict[str, str]:
    return {
        path.relative_to(words.ROOT).as_posix(): path.read_text(encoding="utf-8") for path in words.sources((".py",))
    }


def test_no_private_word_stands_in_the_tree() -> None:
    files = words.sources((".py", *words.TEXTS))
    counted = {str(path): words.private_words(path.read_text(encoding="utf-8")) for path in files}
    assert counted
    assert {path: some for path, some in counted.items() if some} == {}


def test_no_private_name_is_defined() -> None:
    defined = {path: words.private_definitions(text) for path, text in python().items()}
    assert {path: names for path, names in defined.items() if names} == {}


def test_no_unclear_phrase_stands_in_prose() -> None:
    texts = {str(path): path.read_text(encoding="utf-8") for path in words.sources(words.TEXTS)}
    texts |= {path: words.prose(text) for path, text in python().items()}
    assert {path: some for path, text in texts.items() if (some := words.phrases(text))} == {}


def test_locals_say_what_they_hold() -> None:
    vague = [(path, *each) for path, text in python().items() for each in words.vague_locals(text)]
    assert len(vague) <= MAX_VAGUE, vague


def test_participles_are_changed_copies() -> None:
    defined = {
        name for path, text in python().items() if not path.startswith("tests/") for name in words.participles(text)
    }
    assert {name.strip("_") for name in defined} == CHANGED_COPIES | QUESTIONS | DECORATORS | NOUNS


@pytest.mark.parametrize(
    ("text", "seen"),
    [
        ("x = astray", {"astray"}),
        ("state->estimator_astray = 0u;", {"astray"}),
        ("# what the caller is told", {"told"}),
        ("judgement = retold", set()),
    ],
)
def test_a_planted_word_is_seen(text: str, seen: set[str]) -> None:
    assert words.private_words(text) == seen


def test_a_planted_phrase_is_seen_across_lines_of_prose_alone() -> None:
    assert words.phrases(words.prose("# a name that stands\n# twice\nx = 1")) == {"stands twice"}
    assert words.phrases(words.prose("stands, twice = 1, 2")) == set()


def test_a_planted_definition_is_seen() -> None:
    text = "class Found:\n    apart: float\ndef turned(x):\n    names = [x]\n"
    assert words.private_definitions(text) == {"Found", "apart", "turned"}


def test_a_planted_local_is_seen() -> None:
    text = "def f(own):\n    found = 1\n    return [told for told in own]\ndef g(poles):\n    return poles\n"
    assert words.vague_locals(text) == [("f", "found"), ("f", "own"), ("f", "told")]


def test_a_planted_participle_is_seen() -> None:
    assert words.participles("def moved(x): ...\ndef speed(x): ...\ndef test_it_is_moved(): ...\n") == {
        "moved",
        "speed",
    }
