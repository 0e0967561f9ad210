"""Geometry of bodies: where one can stand, step, jump, climb, swim and drop."""
