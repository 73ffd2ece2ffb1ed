"""Answers about settings come through the client as they are: line ends and comments too."""

import json

import pytest

from aff_runtime.app.link.request_client import shown
from aff_runtime.app.link.settings_answer import SettingsAnswer, Version

TEXT = "# b\u00f6se \u202e \x1b[2J\nversion: 1\n\tnot: yaml\r\n"
ROW = Version(number=3, when="now", who="uid 0", verb="kept", why="3 dB", sha256="5e", run="r")


def test_a_text_is_not_escaped_on_its_way_and_words_are():
    answer = SettingsAnswer(text=TEXT, changes=("a: 1 -> 2\nINFO arm",), versions=(ROW,))
    said = shown(json.loads(json.dumps(answer.to_json())))
    found = SettingsAnswer.from_json(said)
    assert found.text == TEXT
    assert "\n" not in found.changes[0]
    assert found.versions == (ROW,)


@pytest.mark.parametrize("text", ["not base64!", "/w=="])
def test_a_text_that_is_none_is_refused(text):
    with pytest.raises(ValueError, match=r"base64|decode"):
        SettingsAnswer.from_json({"text": text})
