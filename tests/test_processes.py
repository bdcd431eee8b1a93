"""Processes that share the tests run every shipped scene once."""

import pytest


def test_tests_of_a_group_stay_in_one_process(request: pytest.FixtureRequest) -> None:
    """pytest-xdist appends the group to the name of a test. If it does not, a group is divided, and every process runs the scenes again."""
    if not getattr(request.config.option, "loadgroup", False):
        pytest.skip("one process runs all tests, or tests are shared in another way")
    assert request.node.nodeid.endswith("@test_processes.py")
