"""What the tests of scene files share."""

import pytest
from bad_files import BAD_FILES


@pytest.fixture(scope='session')
def bad_folder(tmp_path_factory):
    """Return a folder with all the bad files in it."""
    folder = tmp_path_factory.mktemp('bad')
    for name, (content, _) in BAD_FILES.items():
        data = content if isinstance(content, bytes) else content.encode()
        (folder / f'{name}.yaml').write_bytes(data)
    return folder


@pytest.fixture
def write(tmp_path):
    """Return a function that writes a scene file and returns its path."""

    def write_scene(text, name='scene.yaml'):
        path = tmp_path / name
        path.write_text(text, encoding='utf-8')
        return path

    return write_scene
