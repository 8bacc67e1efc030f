"""Cameras, capsules and kinematics: pure functions."""
