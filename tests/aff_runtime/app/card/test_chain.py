"""The chain of a card: no byte differs unseen, and what is no card is refused with its place."""

import hashlib
import json

from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.app.card.chain import LONGEST_LINE, MAX_BYTES, START, canonical, encode, follow
from tests.drawn import drawn
from tests.drawn_text import drawn_text
from tests.each_case import each_case

UTC = "2026-01-02T03:04:05.000+00:00"
TEXTS = drawn_text(max_size=12)
VALUES = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**40), 2**40) | st.floats(-1e9, 1e9) | TEXTS,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(TEXTS, inner, max_size=3),
    max_leaves=6,
)


def written(bodies):
    content, prev = b"", START
    for number, body in enumerate(bodies, start=1):
        line = encode(number=number, utc=UTC, kind="measured", body=body, prev=prev)
        content += line
        prev = json.loads(line)["sha256"]
    return content


SLOW_MACHINE = drawn(quick=6, long=100)
THREE = written([{"a": 1.5}, {"b": "\u00e9\n"}, {"c": [None, True]}])


def test_an_entry_has_the_sha256_of_its_canonical_json():
    first = json.loads(THREE.split(b"\n")[0])
    digest = first.pop("sha256")
    plain = json.dumps(first, sort_keys=True, separators=(",", ":")).encode()
    assert digest == hashlib.sha256(plain).hexdigest()
    assert first["prev"] == "0" * 64


@SLOW_MACHINE
@given(st.lists(st.dictionaries(TEXTS, VALUES, max_size=3), min_size=1, max_size=5))
def test_what_was_written_is_followed_and_read_back(bodies):
    chain = follow(written(bodies))
    assert chain.wrong == ""
    assert [canonical(link.body) for link in chain.links] == [canonical(b) for b in bodies]


@SLOW_MACHINE
@given(
    st.lists(st.dictionaries(TEXTS, VALUES, max_size=2), min_size=1, max_size=3),
    st.randoms(use_true_random=False),
)
def test_any_byte_that_differs_is_found(bodies, random):
    content = bytearray(written(bodies))
    at = random.randrange(len(content))
    content[at] ^= random.randrange(1, 256)
    assert follow(bytes(content)).wrong


def test_every_byte_of_a_card_counts():
    for at in range(len(THREE)):
        for other in (b"", b" ", b"0", THREE[at : at + 1] * 2):
            changed = THREE[:at] + other + THREE[at + 1 :]
            assert changed == THREE or follow(changed).wrong, (at, other)


def test_a_cut_that_is_no_whole_line_is_found():
    ends = [at + 1 for at, byte in enumerate(THREE) if byte == 10]
    for length in range(len(THREE)):
        assert bool(follow(THREE[:length]).wrong) == (length not in ends)


def test_an_entry_taken_out_exchanged_or_put_twice_is_named():
    lines = THREE.split(b"\n")[:-1]
    without = follow(b"\n".join([lines[0], lines[2]]) + b"\n")
    assert without.wrong.startswith("entry 2: its number is 3")
    exchanged = follow(b"\n".join([lines[0], lines[2], lines[1]]) + b"\n")
    assert exchanged.wrong.startswith("entry 2: ")
    other = written([{"a": 2}, {"b": 2}])
    mixed = follow(lines[0] + b"\n" + other.split(b"\n")[1] + b"\n")
    assert "does not follow the entry before it" in mixed.wrong
    assert len(mixed.links) == 1


def with_hash(text):
    said = json.loads(text)
    del said["sha256"]
    return canonical({**said, "sha256": hashlib.sha256(canonical(said)).hexdigest()}) + b"\n"


@each_case(
    ("line", "said"),
    [
        (b"\n", "no JSON"),
        (b"[]\n", "no JSON object"),
        (b"{}\n", "not those of an entry"),
        (b'{"n":1,"n":1}\n', "'n' stands twice"),
        (b'{"n":NaN}\n', "NaN is no number"),
        (b'{"n":-Infinity}\n', "-Infinity is no number"),
        (THREE.split(b"\n")[0].replace(b"1.5", b"1e999") + b"\n", "beyond all floats"),
        (b"\xff\xfe{}\n", "no ASCII"),
        ("{}".encode("utf-16") + b"\n", "no ASCII"),
        (b"[" * 200_000 + b"\n", "nested too deep"),
        (b'{"n":' + b"9" * 10_000 + b"}\n", "no JSON"),
        (b'"' + b"x" * LONGEST_LINE + b'"\n', "longer than"),
        (with_hash(THREE.split(b"\n")[0].replace(b'"n":1', b'"n":true')), "not a whole one"),
        (with_hash(THREE.split(b"\n")[0].replace(b'"kind":"measured"', b'"kind":3')), "no text"),
        (THREE.split(b"\n")[0].replace(b'"n":1', b'"n": 1') + b"\n", "canonical"),
        (THREE.split(b"\n")[0].replace(b"1.5", b"1.6") + b"\n", "it was changed"),
    ],
)
def test_what_is_no_entry_says_which_and_how(line, said):
    found = follow(line).wrong
    assert found.startswith("entry 1: ")
    assert said in found


def test_a_file_without_entries_or_with_far_too_many_is_no_card():
    assert "empty" in follow(b"").wrong
    assert "entries" in follow(b"\n" * 6_000).wrong
    assert "16 MB" in follow(b"x" * (MAX_BYTES + 1)).wrong
