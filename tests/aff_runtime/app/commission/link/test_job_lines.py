"""Every line of a job comes back as it was said, or is refused."""

from pathlib import Path

import pytest

from aff_runtime.app.commission.link import job_lines
from aff_runtime.app.commission.link.answers import Done
from aff_runtime.app.commission.link.job_lines import (
    Ended,
    Refused,
    Reply,
    Start,
    read_line,
    read_reply,
    read_start,
)
from aff_runtime.app.commission.link.messages import Request
from aff_runtime.app.commission.paths import Paths
from aff_runtime.app.commission.views import of_line as views
from tests.each_case import each_case

QUESTION = views.QuestionView(
    number=1, name="host", text="Address", default=None, choices=("no",), rows=(("w2", "word 2"),)
)
SAID = views.SaidLine(kind="complain", text="no")


@each_case(
    "said",
    [SAID, QUESTION, Refused(text="no"), Ended(answer=Done(text="kept"))],
    ids=lambda said: type(said).__name__,
)
def test_a_line_of_a_job_comes_back_as_it_was_said(said):
    assert read_line("keep", job_lines.encode(said).encode()) == said


@each_case("line", [b"", b"[]", b"{}", b'{"sing": "la"}', b'{"say": "a", "b": 1}'])
def test_what_is_no_line_of_a_job_is_refused(line):
    with pytest.raises(ValueError, match=r"\S"):
        read_line("keep", line)


def test_what_a_job_is_told_comes_back_as_it_was_said():
    where = Paths(
        site=Path("s"), state=Path("t"), socket=Path("c"), card=Path("k"), runs=Path("r")
    )
    start = Start(asked=Request(do="step", step=4, by="root"), where=where, parent=17)
    assert read_start(job_lines.encode(start)) == start
    reply = Reply(number=3, text="10.0.0.9")
    assert read_reply(job_lines.encode(reply)) == reply
