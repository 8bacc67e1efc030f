"""Lays finished rows side by side."""
