//! Cluster centres and Gaussian constraint functions sampled on a mesh: rows of H.
