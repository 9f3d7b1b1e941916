"""The numbers that the code is held to: lengths of files and counts of arguments."""

import ast

from source_tree import CHECKOUT, FILES, ROOT, tree

#: Functions of more than eight arguments: questions, which have as many as there is to be asked.
MANY_ARGUMENTS = {
    "api/field.py: field",
    "api/field_question.py: checked_question",
    "api/save_field.py: save_field",
    "fem/question.py: field",
}


def lines_of(path):
    return len(path.read_text(encoding="utf-8").splitlines())


def arguments_of(function):
    """Number of arguments of a function's definition, self and cls aside."""
    named = [a.arg for a in (*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs)]
    return len([name for name in named if name not in ("self", "cls")])


def test_files_have_at_most_350_lines():
    """The package's, and those of tests and experiments."""
    files = [path for top in ("beamprop", "tests", "experiments") for path in (CHECKOUT / top).rglob("*.py")]
    assert len(files) > len(FILES) + 50
    assert [path.relative_to(CHECKOUT).as_posix() for path in files if lines_of(path) > 350] == []


def test_functions_have_at_most_eight_arguments():
    long = {
        f"{path.relative_to(ROOT).as_posix()}: {node.name}"
        for path in FILES
        for node in ast.walk(tree(path))
        if isinstance(node, ast.FunctionDef) and arguments_of(node) > 8
    }
    assert long == MANY_ARGUMENTS
