"""The revision follows the content, not the writing."""

import pytest

from aff_runtime.config.leaves import leaves
from aff_runtime.config.loader import load_site
from aff_runtime.config.revision import site_hash_of
from tests.aff_runtime.config.shipped import EUCLID, edited


def test_writing_does_not_matter(tmp_path):
    path = edited(
        tmp_path,
        ("# Where corrections go in.", "# another comment"),
        ("#deadline_ms: 3.0", "deadline_ms: 3"),
        ("soft_start_s: 1.5", "soft_start_s: 1500 ms"),
    )
    assert site_hash_of(load_site(path)) == site_hash_of(load_site(EUCLID))


@pytest.mark.parametrize(
    "edit",
    [
        ("settle_s: 6,", "settle_s: 6.001,"),
        ("name: Euclid", "name: Euclid 2"),
        ("orders: [1, 2, 3, 4]", "orders: [1, 2, 4, 3]"),
        ("    #resets_on: never", "    resets_on: splice"),
    ],
)
def test_content_matters(edit, tmp_path):
    assert site_hash_of(load_site(edited(tmp_path, edit))) != site_hash_of(load_site(EUCLID))


def test_order_of_channels_matters(tmp_path):
    one = "      tension_ref_N: { register: 4, type: u16, scale: 0.01 }\n"
    two = "      line_speed_m_s: { register: 5, type: i16, scale: 0.001 }\n"
    path = edited(tmp_path, (one + two, two + one))
    assert site_hash_of(load_site(path)) != site_hash_of(load_site(EUCLID))


def test_every_value_of_the_file_is_hashed():
    paths = [leaf.path for leaf in leaves(load_site(EUCLID))]
    assert len(paths) == len(set(paths))
    assert ("actuators", "unwind", "blocks", 1, "settle_s") in paths
    assert ("gateway", "write", "corrections", "unwind", "register") in paths
