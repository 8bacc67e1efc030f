"""Metrics of human motion in scenes: functions and torchmetrics classes."""
