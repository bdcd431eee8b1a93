"""`crosscheck doctor` compares the versions of packages, extras included, with the declared bounds."""

import importlib.metadata

import pytest

from comparison.cli.help_verbs import doctor

DECLARED = ["pydantic>=2.12", "clarabel<0.12,>=0.11", 'ezdxf>=1.2; extra == "drawing"', 'ruff>=0.6; extra == "dev"']


@pytest.mark.parametrize(
    ("version", "allowed", "fits"),
    [
        ("2.6.4", ">=2.12", False), ("2.12", ">=2.12.0", True), ("2.13.0rc1", ">=2.12", True), ("0.12.0", "<0.12,>=0.11", False),
        ("0.11.1", "<0.12,>=0.11", True), ("3.1", "", True),
    ],
)  # fmt: skip
def test_a_version_is_held_against_its_bounds(version: str, allowed: str, fits: bool) -> None:
    assert doctor.is_allowed(version, allowed) == fits


def test_an_old_package_is_no_good_and_a_missing_extra_is_no_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    def version(name: str) -> str:
        if name == "ezdxf":
            raise importlib.metadata.PackageNotFoundError
        return {"pydantic": "2.6.4"}.get(name, "0.11.1")

    monkeypatch.setattr(importlib.metadata, "requires", lambda name: DECLARED)
    monkeypatch.setattr(importlib.metadata, "version", version)
    old, clarabel, extra = [doctor._package(*one) for one in doctor.requirements()]
    assert not old.well and old.needed and old.state == "2.6.4; must be >=2.12" and '"pydantic>=2.12"' in old.remedy
    assert clarabel.well and not extra.well and not extra.needed and extra.part == "ezdxf (extra drawing)"
    monkeypatch.setattr(importlib.metadata, "version", lambda name: "1.1")
    too_old = doctor._package("ezdxf", ">=1.2", "drawing")
    assert [doctor._mark(one) for one in (old, extra, too_old)] == [doctor._mark(old), "– optional", doctor._mark(old)]
    assert "other version needed" in doctor._mark(old)
