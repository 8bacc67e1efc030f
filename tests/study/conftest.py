"""A small study that nobody has answered yet."""

import shutil
from pathlib import Path

import pytest
from study_toys import Client, served, toy_study

from sag.study.folder import Study, read_study


@pytest.fixture(scope="session")
def made_study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a study that no test changes."""
    return toy_study(tmp_path_factory.mktemp("made") / "study").folder


@pytest.fixture
def study(tmp_path: Path, made_study: Path) -> Study:
    """Three scenes, three methods and the ground truth, two motions that come again."""
    return read_study(shutil.copytree(made_study, tmp_path / "study"))


@pytest.fixture
def server(study):
    """The study, served."""
    with served(study) as running:
        yield running


@pytest.fixture
def client(server) -> Client:
    """Somebody with a session."""
    return Client(server.server_address[1]).begin()
