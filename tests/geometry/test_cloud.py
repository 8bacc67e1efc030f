"""An index over a cloud: no point within a radius of a segment is missed, and none is named twice."""

import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from sag.geometry.capsule import squared_distance_to_segment
from sag.geometry.cloud import IndexedCloud, indexed


@given(seed=st.integers(0, 10_000), radius=st.floats(0.005, 0.6), length=st.floats(0, 3))
@settings(max_examples=60, deadline=None)
def test_every_point_within_the_radius_is_a_candidate_once(seed, radius, length):
    generator = torch.manual_seed(seed)
    points, starts, along = (torch.randn(n, 3, generator=generator, dtype=torch.float64) for n in (1500, 7, 7))
    ends = starts + length * torch.nn.functional.normalize(along, dim=-1)
    segment, point = IndexedCloud(points).near_segments(starts, ends, radius)
    pairs = set(zip(segment.tolist(), point.tolist()))
    inside = squared_distance_to_segment(points, starts[:, None], ends[:, None]) <= radius**2
    assert {tuple(pair) for pair in inside.nonzero().tolist()} <= pairs
    assert len(pairs) == len(segment)


def test_candidates_are_near():
    points = torch.randn(5000, 3, generator=torch.manual_seed(0), dtype=torch.float64)
    start, end = torch.zeros(1, 3, dtype=torch.float64), torch.tensor([[0.5, 0, 0]], dtype=torch.float64)
    _, point = IndexedCloud(points).near_segments(start, end, 0.1)
    assert len(point) and squared_distance_to_segment(points[point], start, end).max() <= 2 * 0.1**2 + 1e-6


def test_an_index_is_taken_as_it_is_and_points_get_one():
    cloud = IndexedCloud(torch.zeros(3, 3))
    assert indexed(cloud) is cloud and len(indexed(torch.zeros(4, 3))) == 4


def test_a_cloud_without_points_has_no_candidates():
    segment, point = IndexedCloud(torch.zeros(0, 3)).near_segments(torch.zeros(2, 3), torch.ones(2, 3), 1.0)
    assert len(segment) == len(point) == 0
