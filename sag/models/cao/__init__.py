"""Cao et al.'s three networks (ECCV 2020): a goal, the path to it, the pose along the path."""
