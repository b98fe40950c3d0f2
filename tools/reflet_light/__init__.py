"""Scene text in Mitsuba 3, to compare converged pictures; see tools/documents/light.py."""
