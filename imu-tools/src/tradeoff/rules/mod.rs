//! Integration rules: how far off each is, on smooth and rough motions, at any rate and in any numbers; and what it
//! costs.

pub mod follow;
pub mod motion;
