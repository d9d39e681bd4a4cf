//! Tests of the server of the studio, by requests as a browser sends them.

mod client;
mod field_edits;
mod graphs;
mod grids;
mod guard;
mod pose;
mod server;
mod tools;
mod turned;
