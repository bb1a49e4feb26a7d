//! Blend-shape driver: weights in, posed positions and normals at material points out.
