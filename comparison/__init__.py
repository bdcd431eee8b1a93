"""Runs both methods on a scene, judges one by the other, and reports.

Nothing is loaded before it is asked for: drawing takes a second that most commands can save. The names in `__all__`
are stable; type checkers read them in `__init__.pyi`.
"""

from importlib import import_module as _load

_HOMES = {
    "CampaignChanges": "campaign_result",
    "CampaignResult": "campaign_result",
    "Check": "verdict",
    "Picture": "picture",
    "Result": "result",
    "Run": "yade",
    "Verdict": "verdict",
    "compare": "campaign_result",
    "draw": "picture",
    "export": "result",
    "read": "result",
    "read_campaign": "campaign_result",
    "run": "result",
    "run_campaign": "campaign_result",
}
__all__ = sorted(_HOMES)  # noqa: PLE0605


def __getattr__(name: str) -> object:
    """A stable name, from the module where it lives (PEP 562)."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(_load(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return [*globals(), *__all__]
