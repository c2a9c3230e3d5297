//! `softshadow-bench`: technique × scene × settings → time, bytes, error.
//!
//! Every number is a pair: milliseconds, and the error against a reference of many rays. Cases take turns in one run, after a
//! warm-up; times are medians, with the fastest and slowest beside them. They hold for the machine that made them alone: compare
//! ratios. `ms` is from plan to values, receivers included, `call ms` what the caller waits. `MiB` is exact, from the plan of
//! the largest stage. `passes` is the share of the wall time that passes explain, in runs of their own in which every pass is a
//! submission.
//!
//! Errors of a case with a picture are those of its visibility. Half opaque scenes have references of their own.
//!
//! A sweep moves the light, the receivers or an object, and tells by how much the error changes from a frame to the next.
//!
//! A waving scene moves from frame to frame: `refit ms` is what the library takes to come from the last frame to this one, `build
//! ms` what the same vertices cost as a new scene, in turns; `ms` is the shadows of the frame that was refitted. Both must give the same
//! values.

mod case;
mod error;
mod measure;
mod progress;
mod ratios;
mod reference;
mod report;
mod resume;
mod scenes;
mod session;
mod statistics;
mod sweep;
mod table;
mod waving;

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use softshadow::{DeviceChoice, Technique};

use crate::case::{Case, parse_technique};
use crate::ratios::Chosen;
use crate::session::Session;

/// Measures shadow techniques: time, bytes and error against a reference of many rays.
#[derive(Debug, Parser)]
#[command(name = "softshadow-bench", version, after_help = after_help())]
pub(crate) struct Arguments {
    /// A scene's name, a mesh such as cow.obj, any scene.json with a light and a camera, or a folder of meshes; may be given several times
    #[arg(long = "scene", value_name = "NAME", default_values = ["fork", "bunny"])]
    pub(crate) scenes: Vec<String>,
    /// A technique with settings, such as depth-complexity:samples=64,exact_area=true; +integrated or
    /// +modulated adds the picture, +semi-opaque lets half of the light through every triangle
    #[arg(long = "technique", value_name = "CASE", value_parser = str::parse::<Case>)]
    pub(crate) cases: Vec<Case>,
    /// Measures ratios, too: every case that they name, beside what is published and asked
    #[arg(long, value_name = "WHICH", num_args = 0..=1, default_missing_value = "all")]
    pub(crate) ratios: Option<Chosen>,
    /// Lets every scene sway for so many frames, too: milliseconds of refits, of scenes made anew, and of shadows
    #[arg(long, value_name = "FRAMES", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) waving: Option<u32>,
    /// Sweeps light, receivers and an object over so many frames, too: flicker and the largest jump of every technique
    #[arg(long, value_name = "FRAMES", value_parser = clap::value_parser!(u32).range(2..))]
    pub(crate) sweep: Option<u32>,
    /// Pixels: a number for a square, or WIDTHxHEIGHT; may be given several times
    #[arg(long = "size", value_name = "PIXELS", value_parser = parse_size, default_value_ifs([("quick", "true", "128")]),
        default_values = ["512"])]
    pub(crate) sizes: Vec<[u32; 2]>,
    /// Under two minutes: small images, three turns, and a reference of fewer rays; what is given beside it counts
    #[arg(long)]
    pub(crate) quick: bool,
    /// Leaves out what the file of --json has of this device and these settings already, and adds to it
    #[arg(long, requires = "json")]
    pub(crate) resume: bool,
    /// Turns after the warm-up
    #[arg(long, value_name = "N", default_value_t = 7, default_value_if("quick", "true", "3"), value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) repeats: u32,
    /// What errors are measured against
    #[arg(long, value_name = "TECHNIQUE", value_parser = parse_technique,
        default_value = "ray_traced:samples=256,passes=16,pattern=low_discrepancy,seed=99",
        default_value_if("quick", "true", "ray_traced:samples=256,passes=4,pattern=low_discrepancy,seed=99"))]
    pub(crate) reference: Technique,
    /// A folder in which references are kept and found again; delete it after a change to the reference's own code
    #[arg(long, value_name = "FOLDER")]
    pub(crate) reference_cache: Option<PathBuf>,
    /// auto, gpu, software, or an adapter's index
    #[arg(long, default_value = "auto", value_parser = str::parse::<DeviceChoice>)]
    pub(crate) device: DeviceChoice,
    /// Writes a line of JSON for every measurement, ratio, skip and failure
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,
}

fn after_help() -> String {
    let techniques: Vec<&str> = Technique::defaults().iter().map(Technique::name).collect();
    format!(
        "Scenes: {}\nTechniques: {}\nMeshes are found in SOFTSHADOW_MESHES or ../shared/meshes; a scene whose mesh is missing is \
         skipped, and counted.",
        scenes::names().join(", "),
        techniques.join(", ")
    )
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let (width, height) = text.split_once('x').unwrap_or((text, text));
    match (width.parse(), height.parse()) {
        (Ok(width @ 1..), Ok(height @ 1..)) => Ok([width, height]),
        _ => Err("pixels such as 512, or WIDTHxHEIGHT such as 1024x768".into()),
    }
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let mut out = std::io::stdout();
    match Session::new(&arguments, &mut out).and_then(Session::run) {
        Ok(0) => ExitCode::SUCCESS,
        // Failures are in the table already.
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            // Where even stderr is closed nobody is left to tell.
            let _ = writeln!(std::io::stderr(), "softshadow-bench: {error}");
            ExitCode::FAILURE
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent_and_its_defaults_parse() {
        Arguments::command().debug_assert();
        let defaults = Arguments::try_parse_from(["softshadow-bench"]).unwrap();
        assert_eq!((defaults.sizes, defaults.repeats), (vec![[512, 512]], 7));
        assert_eq!(defaults.reference.samples() * defaults.reference.passes(), 4096);
        let quick = Arguments::try_parse_from(["softshadow-bench", "--quick", "--repeats", "2"]).unwrap();
        assert_eq!((quick.sizes, quick.repeats, quick.reference.passes()), (vec![[128, 128]], 2, 4));
        assert!(Arguments::try_parse_from(["softshadow-bench", "--resume"]).is_err(), "there is nothing to resume");
    }

    #[test]
    fn sizes_are_squares_or_two_numbers() {
        assert_eq!((parse_size("64"), parse_size("64x48")), (Ok([64, 64]), Ok([64, 48])));
        for wrong in ["0", "64x", "x", "64x0", "a", "-1"] {
            assert!(parse_size(wrong).is_err(), "{wrong}");
        }
    }
}
