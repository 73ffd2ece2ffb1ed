import inspect
import pkgutil

import sim_plant.effects
from sim_plant.effects.catalogue import BY_NAME, CATALOGUE


def test_every_effect_file_has_one_row_under_its_own_name():
    files = {
        name for _f, name, _p in pkgutil.iter_modules(sim_plant.effects.__path__)
        if hasattr(__import__(f"sim_plant.effects.{name}", fromlist=["EFFECT"]), "EFFECT")
    }  # fmt: skip
    assert files == set(BY_NAME)
    assert len(BY_NAME) == len(CATALOGUE)


def test_every_row_explains_itself():
    for effect in CATALOGUE:
        assert len(effect.text) > 20
        assert effect.parameters
        assert inspect.getdoc(effect.apply)
