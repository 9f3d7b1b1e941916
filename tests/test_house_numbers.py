"""The numbers that the code is held to: lengths of files, counts of arguments, shares of names."""

import ast
import re

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


#: Words that say nothing of the thing that they name.
INDEFINITE = {"asked", "few", "found", "one", "other", "others", "some"}


def names_defined(node):
    """Names that a syntax tree defines: variables, attributes, arguments, functions and classes."""
    for n in ast.walk(node):
        if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store):
            yield n.id
        elif isinstance(n, ast.Attribute) and isinstance(n.ctx, ast.Store):
            yield n.attr
        elif isinstance(n, ast.arg):
            yield n.arg
        elif isinstance(n, ast.FunctionDef | ast.ClassDef):
            yield n.name


def is_indefinite(name):
    """Whether a name has an indefinite word among its words."""
    return bool(INDEFINITE & set(re.findall("[a-z]+", name.lower())))


def test_names_say_what_they_name():
    """At most one name in two hundred has an indefinite word in it."""
    names = [name for path in FILES for name in names_defined(tree(path))]
    indefinite = sorted(name for name in names if is_indefinite(name))
    assert len(indefinite) <= 0.005 * len(names), f"{len(indefinite)} of {len(names)}: {indefinite}"


def test_indefinite_names_are_recognised():
    source = "class Other:\n def one_of(self, some):\n  self.found, stone = [other for other in some]"
    indefinite = [name for name in names_defined(ast.parse(source)) if is_indefinite(name)]
    assert sorted(indefinite) == ["Other", "found", "one_of", "other", "some"]
