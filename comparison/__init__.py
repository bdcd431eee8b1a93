"""Runs both methods on a scene, judges one by the other, and reports.

The stable names:

- `run`, `read`: run a scene by both methods, or read stored results; both return a `Result`, with `Check`, `Verdict`
  and YADE's `Run` in it.
- `draw`, `export`: draw a scene or an answer as a `Picture`; write results for ParaView.
- `run_campaign`, `read_campaign`: run a campaign, or read its results; both return a `CampaignResult`.
- `compare`: compare two campaigns; returns `CampaignChanges`.
- `animate`: write the settlement as a GIF or MP4.
- `cost`, `sensitivity`: study error against time, or the classic iteration; return `CostResult` and `SensitivityResult`.

All other names may change. Each name is loaded on first use: most commands draw nothing, and save the second that drawing takes to load.
Type checkers read the stable names in `__init__.pyi`.
"""

from importlib import import_module as _load

_HOMES = {
    "CampaignChanges": "campaign_result",
    "CampaignResult": "campaign_result",
    "Check": "verdict",
    "CostResult": "study_result",
    "Picture": "picture",
    "Result": "result",
    "Run": "yade",
    "SensitivityResult": "study_result",
    "Verdict": "verdict",
    "animate": "result",
    "compare": "campaign_result",
    "cost": "study_result",
    "draw": "picture",
    "export": "result",
    "read": "result",
    "read_campaign": "campaign_result",
    "run": "result",
    "run_campaign": "campaign_result",
    "sensitivity": "study_result",
}
__all__ = sorted(_HOMES)  # noqa: PLE0605


def __getattr__(name: str) -> object:
    """A stable name, from the module where it lives (PEP 562); raises ImportError on Windows."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    if _load("sys").platform == "win32":
        raise ImportError(_load("la_core.errors").ON_WINDOWS)
    return getattr(_load(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return [*globals(), *__all__]
