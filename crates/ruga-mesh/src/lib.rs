//! Topology, typed ids, material points, Loop subdivision and surface lookup for triangle meshes.
