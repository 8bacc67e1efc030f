"""The paper's networks; no Lightning here."""
