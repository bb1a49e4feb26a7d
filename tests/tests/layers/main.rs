//! Layers on layers, painted layers, and meshes that change: one program, whose long tests run side
//! by side.

mod crests;
mod joint;
mod painted;
mod remeshing;
mod stack;
