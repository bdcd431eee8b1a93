"""Made-up paths for tests: reports of progress, and a test's actions between them, without minutes of waiting."""

from collections.abc import Callable

import pytest

from la_core.analysis import one_pass
from la_core.analysis.settings import Silent
from la_core.coulomb import PathProgress

REPORTS = tuple(PathProgress(0.25 * k, 0.25 * k, 100.0 + k, 0.01, 1 + k // 2, 2) for k in range(4))


def with_reports(
    monkeypatch: pytest.MonkeyPatch,
    meanwhile: Callable[[PathProgress], None] = lambda report: None,
    reports: tuple[PathProgress, ...] = REPORTS,
) -> list[object]:
    """Make every prediction first send these reports of its paths. `meanwhile` is called after each report.

    Returns the list of the scenes predicted so far, which grows with every prediction.
    """
    predicted: list[object] = []
    original = one_pass.with_prediction

    def reporting(model, bounds, settings, listener):
        predicted.append(model.scene)
        for report in reports:
            listener.path(report)
            meanwhile(report)
        return original(model, bounds, settings, Silent())

    monkeypatch.setattr(one_pass, "with_prediction", reporting)
    return predicted
