"""How many there are of something, in a sentence."""

from aff_runtime.base.counted_noun import counted


def test_one_has_no_plural_and_none_is_a_word():
    said = [counted(n, "value") for n in (0, 1, 2)]
    assert said == ["no values", "1 value", "2 values"]
