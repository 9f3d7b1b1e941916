"""Texts of study files, written and refused."""

import pytest

from beamprop.study import files


def written(folder, text, name="study.toml"):
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


def wrong(folder, text):
    """Path -> what is said of each mistake in a file."""
    with pytest.raises(files.Mistakes) as caught:
        files.read(written(folder, text))
    return dict(str(mistake).split(": ", 1) for mistake in caught.value.wrong)
