"""Runs suites of others, whose folders are given: nothing of the suites is part of the project."""
