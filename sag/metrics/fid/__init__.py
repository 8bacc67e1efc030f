"""Motion FID and what rests on its features: KID, floor, interval, infinite N, multimodality."""
