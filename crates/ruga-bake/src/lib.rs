//! Wrinkle maps: rasterisation in UV, tangent frames, padding, packing.
