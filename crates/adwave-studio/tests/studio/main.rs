//! The server of the studio, asked as a browser asks it.

mod client;
mod guard;
mod server;
mod tools;
