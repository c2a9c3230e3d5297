"""Measuring beside others: the same scenes, receivers and light samples for independent ray tracers.

Needs the extra ``softshadow[bench]``; a tracer that is not installed is skipped by name.
"""
