from dataclasses import asdict, fields

from sag.components import Components
from sag.letters import LETTERS, row_name


def test_every_component_has_a_letter_and_every_letter_a_component():
    assert [field.name for field in fields(Components)] == list(LETTERS)


def test_components_and_letters_name_a_row_alike():
    for components in (Components(), Components(False, False, False, False), Components(depth=False)):
        assert components.letters == row_name(asdict(components))
