"""Catmull-Clark refinement."""
