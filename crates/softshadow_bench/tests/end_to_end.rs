//! The binary as a person runs it, on small images of shipped scenes.

use std::path::PathBuf;
use std::process::{Command, Output};

use serde_json::Value;

fn bench(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_softshadow-bench"));
    command.args(arguments).env("SOFTSHADOW_MESHES", "/nowhere");
    command.output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn scratch(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("softshadow-bench-end-{}-{name}", std::process::id()))
}

#[test]
fn a_run_measures_says_and_records() {
    let (json, cache) = (scratch("lines.json"), scratch("references"));
    let run = || {
        let output = bench(&[
            "--scene",
            "fork",
            "--scene",
            "bunny",
            "--size",
            "48x32",
            "--repeats",
            "3",
            "--technique",
            "hard-shadow-map:resolution=256",
            "--technique",
            "depth_complexity:samples=64+modulated",
            "--ratios",
            "--waving",
            "2",
            "--reference",
            "ray_traced:samples=64,passes=4,pattern=low_discrepancy",
            "--reference-cache",
            cache.to_str().unwrap(),
            "--json",
            json.to_str().unwrap(),
        ]);
        assert!(output.status.success(), "{}{}", text(&output.stdout), text(&output.stderr));
        let lines: Vec<Value> =
            std::fs::read_to_string(&json).unwrap().lines().map(|l| serde_json::from_str(l).unwrap()).collect();
        (text(&output.stdout), lines)
    };
    let (said, lines) = run();
    for expected in ["fork, 48 × 32, 446 triangles", "ray_traced with 256 samples", "count reference depth", "in all"]
    {
        assert!(said.contains(expected), "{expected} in {said}");
    }
    assert!(said.contains("skip: bunny: /nowhere/stanford-bunny.obj is missing"), "{said}");
    assert!(said.ends_with("1 scenes skipped, 0 cases failed\n"), "{said}");

    let of = |kind: &str| lines.iter().filter(|l| l["kind"] == kind).collect::<Vec<_>>();
    assert_eq!((of("skip").len(), of("failure").len()), (1, 0));
    assert!(of("ratio").len() >= 5 && of("ratio").iter().all(|r| r["median"].as_f64().unwrap() > 0.0));
    let hard = of("measurement")[0];
    assert_eq!(
        (&hard["technique"]["name"], &hard["technique"]["resolution"]),
        (&"hard_shadow_map".into(), &256.into())
    );
    assert_eq!((&hard["size"], hard["wall_ms"].as_array().unwrap().len()), (&serde_json::json!([48, 32]), 3));
    // A hard edge is far from a soft one, and edges are near rays.
    let rmse = |row: &Value| row["errors"]["penumbra"]["rmse"].as_f64().unwrap();
    let soft = of("measurement")[1];
    assert_eq!((&soft["picture"], soft["errors"]["gross_count"].as_u64()), (&"modulated".into(), Some(0)));
    assert!(rmse(hard) > 0.1 && rmse(soft) < 0.03, "{} {}", rmse(hard), rmse(soft));
    for row in of("measurement") {
        let bytes = row["bytes"].as_array().unwrap().iter().map(|b| b[1].as_u64().unwrap()).sum::<u64>();
        assert_eq!(row["bytes_in_all"].as_u64(), Some(bytes));
        let share = row["pass_share"].as_f64().unwrap();
        assert!(share > 0.0 && share <= 1.0 && row["median_call_ms"].as_f64() >= row["median_wall_ms"].as_f64());
        assert!(row["reference_standard_error"].as_f64().unwrap() > 0.0);
        assert!(row["environment"]["adapter"]["driver"].is_string());
    }

    // Half of the light passes, and the reference knows it.
    let half = of("measurement").into_iter().find(|row| row["semi_opaque"] == true).unwrap();
    assert!(rmse(half) < 0.03 && half["reference_standard_error"] != soft["reference_standard_error"], "{half}");
    for row in of("waving") {
        let frames = |key: &str| row[key].as_array().unwrap().iter().filter(|ms| ms.as_f64().unwrap() > 0.0).count();
        assert_eq!(["refit_ms", "build_ms", "wall_ms", "call_ms"].map(frames), [2; 4], "{row}");
        assert_eq!(
            (&row["differing_receivers"], &row["rebuild_reasons"]),
            (&0.into(), &serde_json::json!([])),
            "{row}"
        );
    }
    assert_eq!(of("waving").len(), of("measurement").len());

    // The kept references serve the next run, bit by bit.
    let kept = std::fs::read_dir(&cache).unwrap().map(|f| f.unwrap().metadata().unwrap().modified().unwrap());
    let kept: Vec<_> = kept.collect();
    let (_, again) = run();
    assert_eq!(again[0]["errors"], hard["errors"]);
    let still: Vec<_> =
        std::fs::read_dir(&cache).unwrap().map(|f| f.unwrap().metadata().unwrap().modified().unwrap()).collect();
    assert_eq!((kept.len(), &kept), (2, &still));
}

#[test]
fn sweeps_tell_what_jumps_from_what_slides() {
    let json = scratch("sweeps.json");
    let mut arguments = vec!["--scene", "fork", "--size", "48x32", "--repeats", "1", "--sweep", "3"];
    arguments.extend(["--technique", "ray_traced:samples=1", "--technique", "depth_complexity:samples=64"]);
    arguments.extend(["--technique", "depth_complexity:samples=16,spread=interleaved"]);
    arguments.extend(["--reference", "ray_traced:samples=64,passes=4,pattern=low_discrepancy"]);
    arguments.extend(["--device", "native", "--json", json.to_str().unwrap()]);
    let output = bench(&arguments);
    assert!(output.status.success(), "{}{}", text(&output.stdout), text(&output.stderr));
    let lines = std::fs::read_to_string(&json).unwrap();
    let lines: Vec<Value> = lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let sweeps: Vec<&Value> = lines.iter().filter(|line| line["kind"] == "sweep").collect();
    // Points have no neighbours to be averaged with.
    assert_eq!(sweeps.len(), 3 * 3 - 1, "{lines:?}");
    for moving in ["light", "receivers", "object"] {
        let of_case = |name: &str| {
            let row = sweeps.iter().find(|row| row["moving"] == moving && row["technique"]["name"] == name);
            let steady = row.unwrap()["steadiness"].clone();
            ["flicker", "largest_jump", "reference_flicker"].map(|key| steady[key].as_f64().unwrap())
        };
        // One sample is a hard edge, and jumps where it moves.
        let ([hard, pops, own], [soft, slides, _]) = (of_case("ray_traced"), of_case("depth_complexity"));
        assert!(
            soft < 0.6 * hard && slides < pops && own < 0.1 * hard,
            "{moving}: {soft} {slides} {hard} {pops} {own}"
        );
    }
}

#[test]
fn an_ended_run_goes_on_where_it_stopped() {
    let json = scratch("resumed.json");
    let run = |scenes: &[&str]| {
        let mut arguments = vec!["--quick", "--resume", "--size", "24", "--repeats", "1", "--device", "native"];
        arguments.extend(scenes.iter().flat_map(|scene| ["--scene", scene]));
        arguments.extend(["--technique", "ray_traced:samples=16", "--json", json.to_str().unwrap()]);
        let output = bench(&arguments);
        assert!(output.status.success(), "{}{}", text(&output.stdout), text(&output.stderr));
        let lines = std::fs::read_to_string(&json).unwrap();
        (text(&output.stdout), lines.lines().filter(|line| line.contains("\"measurement\"")).count())
    };
    let (first, lines) = run(&["fork"]);
    assert!(!first.contains("measured before") && lines == 1, "{first}");
    // The end of a line that was never finished.
    let half = std::fs::read_to_string(&json).unwrap() + "{\"kind\": \"measu";
    std::fs::write(&json, half).unwrap();
    let (second, lines) = run(&["fork", "toruses"]);
    assert!(second.contains("fork, 24 × 24: measured before") && lines == 2, "{second}");
    // Other lines are no benchmark's.
    std::fs::write(&json, "nonsense\n").unwrap();
    let output = bench(&["--resume", "--scene", "fork", "--size", "8", "--json", json.to_str().unwrap()]);
    assert!(text(&output.stderr).contains("line 1"), "{}", text(&output.stderr));
}

#[test]
fn what_a_scene_refuses_is_a_named_failure_among_the_others() {
    let output = bench(&[
        "--scene",
        "canopy",
        "--size",
        "64",
        "--repeats",
        "1",
        "--technique",
        "depth_complexity:unit=edges",
        "--technique",
        "ray_traced:samples=16",
        "--reference",
        "ray_traced:samples=64",
    ]);
    let said = text(&output.stdout);
    assert!(!output.status.success());
    assert!(said.contains("failure: canopy, depth_complexity:unit=edges: "), "{said}");
    assert!(said.contains("ray_traced:samples=16") && said.ends_with("0 scenes skipped, 1 cases failed\n"), "{said}");
}

#[test]
fn nonsense_is_refused_with_the_way_out() {
    for (arguments, expected) in [
        (&["--scene", "moon"][..], "choose one of canopy"),
        (&["--technique", "ray_traced:rays=3"], "unknown field `rays`"),
        (&["--size", "0"], "WIDTHxHEIGHT"),
        (&["--repeats", "0"], "0 is not in 1.."),
        (&["--waving", "0"], "0 is not in 1.."),
        (&["--sweep", "1"], "1 is not in 2.."),
        (&["--resume"], "--json"),
        (&["--ratios", "some"], "[possible values: all, published]"),
        (&["--scene", "fork", "--size", "8", "--reference", "hard_shadow_map"], "has no standard error"),
        (&["--device", "quantum"], "none of 'auto', 'gpu', 'native', 'software'"),
    ] {
        let output = bench(arguments);
        assert!(!output.status.success());
        let said = text(&output.stderr);
        assert!(said.contains(expected), "{expected} in {said}");
    }
}
