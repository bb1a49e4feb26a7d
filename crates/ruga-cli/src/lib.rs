//! The command ruga: bake, simulate, plan, check, new.
