//! Plans and runs the wrinkling of one pose: region, mesh, load steps, report.
