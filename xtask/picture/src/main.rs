//! `lahar-picture <folder> <picture.png>`: draws six of a folder's frames.
#![allow(clippy::print_stderr)] // a command line talks to the terminal

use std::path::Path;
use std::process::ExitCode;

use lahar_picture::{draw, read_frames, spread};

fn main() -> ExitCode {
    let arguments: Vec<_> = std::env::args_os().skip(1).collect();
    let [folder, picture] = arguments.as_slice() else {
        eprintln!("usage: lahar-picture <folder with .vtp files> <picture.png>");
        return ExitCode::FAILURE;
    };
    let frames = read_frames(Path::new(folder)).map(|all| spread(all, 6));
    match frames.and_then(|frames| draw(&frames, Path::new(picture))) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("lahar-picture: {message}");
            ExitCode::FAILURE
        }
    }
}
