//! Pages of pictures and numbers: the report of one shape, and every figure and table of the paper made again.

pub mod reproduce;
