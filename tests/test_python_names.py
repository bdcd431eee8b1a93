"""The names of the Python interface are stable and described, and their examples are true."""

import ast
import doctest
import importlib
import inspect
import re
import sys
from collections.abc import Callable
from pathlib import Path
from types import FunctionType

import api_page
import pytest

import comparison
import la_core

ROOT = Path(__file__).parent.parent
ELASTIC = 1e-3  # of the weight: joints are elastic in the prediction
both_packages = pytest.mark.parametrize("package", [la_core, comparison], ids=lambda package: package.__name__)


@both_packages
def test_stable_names_are_those_that_type_checkers_read(package) -> None:
    stub = ast.parse((ROOT / package.__name__ / "__init__.pyi").read_text(encoding="utf-8"))
    homes = {alias.name: node.module for node in stub.body if isinstance(node, ast.ImportFrom) for alias in node.names}
    assert package.__all__ == sorted(homes)
    for name, home in homes.items():
        assert getattr(package, name) is getattr(importlib.import_module(home), name)
        assert name in dir(package)
    (listed,) = (ast.literal_eval(node.value) for node in stub.body if isinstance(node, ast.Assign))
    assert listed == package.__all__


@both_packages
def test_help_begins_with_the_stable_names(package) -> None:
    assert set(package.__all__) <= set(re.findall(r"`(\w+)`", package.__doc__))


@both_packages
def test_a_name_that_is_none_is_told_as_python_tells_it(package) -> None:
    with pytest.raises(AttributeError, match=f"module '{package.__name__}' has no attribute 'reticulate'"):
        package.reticulate  # noqa: B018


def test_the_page_of_names_is_that_of_the_docstrings() -> None:
    assert api_page.PAGE.read_text(encoding="utf-8") == api_page.page()


def described(thing: object, heading: str) -> dict[str, str]:
    """Meaning of every entry of a docstring's section, by name."""
    return {entry.name.lstrip("*"): entry.meaning for entry in api_page.entries(api_page.sections(thing).get(heading, ""))}


def assert_call_is_described(function: Callable[..., object]) -> None:
    """A docstring lists every parameter with its type and meaning, in order, and what the function returns."""
    parameters = [name for name in inspect.signature(function).parameters if name != "self"]
    meanings = described(function, "Parameters")
    assert list(meanings) == parameters
    assert all(entry.kind and entry.meaning for entry in api_page.entries(api_page.sections(function).get("Parameters", "")))
    assert any(described(function, "Returns").values())


@both_packages
def test_every_parameter_and_attribute_of_the_names_is_described(package) -> None:
    for thing in (getattr(package, name) for name in package.__all__):
        assert api_page.sections(thing)[""], thing
        if not inspect.isclass(thing):
            assert_call_is_described(thing)
            continue
        meanings = described(thing, "Attributes")
        assert list(meanings) == api_page.fields_of(thing)
        assert all(meanings.values())
        assert all(inspect.getdoc(member) for member in api_page.members_of(thing, property).values())
        for method in api_page.members_of(thing, FunctionType).values():
            assert_call_is_described(method)
    assert list(described(la_core.SceneError, "Parameters")) == list(inspect.signature(la_core.SceneError).parameters)


def test_sections_of_a_docstring_are_read_as_numpydoc_has_them() -> None:
    def area(width: float, *others: float) -> float:
        """Return an area.

        Parameters
        ----------
        width : float
            Width of the
            strip, m.
        *others : float
            More widths, m.

        Returns
        -------
        float
            Area, m2.
        """
        return width + sum(others)

    assert api_page.sections(area)[""] == "Return an area."
    (width, others) = api_page.entries(api_page.sections(area)["Parameters"])
    assert width == ("width", "float", "Width of the strip, m.")
    assert others == ("*others", "float", "More widths, m.")
    assert_call_is_described(area)
    with pytest.raises(AssertionError):
        assert_call_is_described(test_sections_of_a_docstring_are_read_as_numpydoc_has_them)


@both_packages
def test_examples_of_the_names_are_true(package, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("comparison.figures.report_figures", lambda *results: {})  # figures of the report, which this test does not need
    tried = 0
    for name in package.__all__:
        for example in doctest.DocTestFinder(recurse=False).find(getattr(package, name), name, module=False, globs={}):
            result = doctest.DocTestRunner().run(example)
            assert result.failed == 0
            tried += result.attempted
    assert tried


@pytest.mark.yade
def test_the_code_of_the_readme_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("comparison.figures.report_figures", lambda *results: {})  # figures of the report, which this test does not need
    (code,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    monkeypatch.chdir(tmp_path)
    exec(code, {})
    predicted, found, verdict = capsys.readouterr().out.split()
    weight = la_core.load("two_blocks").weight
    assert [float(predicted), float(found)] == pytest.approx([0.5 * weight] * 2, abs=ELASTIC * weight)
    assert verdict == "agree"
    assert (tmp_path / "mechanisms.png").read_bytes().startswith(b"\x89PNG")


def test_loading_the_packages_draws_nothing() -> None:
    program = "import comparison, la_core, sys; print(any(name in sys.modules for name in ('matplotlib', 'numpy', 'pydantic')))"
    import subprocess

    said = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert said.strip() == "False"
