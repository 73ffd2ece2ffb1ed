"""The bench of the kernel runs and names its ways."""

from benchmarks.kernel.__main__ import Way, measured


def test_a_way_is_compared_with_the_first_one() -> None:
    done = []
    ways = [Way(name=name, work=lambda name=name: done.append(name), steps=10.0) for name in "ab"]
    section = measured("title", "note", ways, turns=2)
    assert done == ["a", "b"] * 3  # in turns, the first one warm
    assert [row.name for row in section.rows] == ["a", "b"]
    assert section.rows[0].remark == ""
    assert section.rows[1].remark.endswith(" x")
