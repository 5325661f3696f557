"""Names in every form that can be listed, and what is no list of names."""

import numpy as np
import pytest

from synth.errors import SignalError
from synth.synthesise import names


@pytest.mark.parametrize("given", [["gap", "tilt"], ("gap", "tilt"), np.array(["gap", "tilt"]), {"gap": 1, "tilt": 2}])
def test_any_list_of_texts_is_read(given: object) -> None:
    found = names.of("outputs", given)
    assert found == ("gap", "tilt")
    assert all(type(name) is str for name in found)


def test_one_text_is_one_name_and_none_are_none() -> None:
    assert names.of("outputs", "gap") == ("gap",)
    assert names.of("outputs", []) == ()
    assert names.of("outputs", iter(["gap"])) == ("gap",)


@pytest.mark.parametrize("given", [None, 3, [3], [None], [["gap"]], np.array([["gap", "tilt"]])])
def test_what_is_no_list_of_names_is_refused(given: object) -> None:
    with pytest.raises(SignalError, match=r"the outputs are .*: give names of signals, in one list"):
        names.of("outputs", given)
