//! Work that is counted instead of timed: it is the same on every machine, and must not grow unnoticed.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::Command;

use serde_json::Value;

/// Scene and case, to counts by name.
type Counts = BTreeMap<String, BTreeMap<String, u64>>;

/// What may be more than what is kept: lists differ a little where compilers order sums differently.
const FACTOR: f64 = 1.05;
const CASES: [&str; 5] = [
    "ray_traced:samples=64",
    "ray_traced:samples=64,probes=16",
    "depth_complexity:samples=64",
    "depth_complexity:samples=256",
    "depth_complexity:samples=64,spread=interleaved",
];

fn kept_file() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("results/counted_work.json")
}

fn counted() -> Counts {
    let json = std::env::temp_dir().join(format!("softshadow-counted-{}.json", std::process::id()));
    let mut command = Command::new(env!("CARGO_BIN_EXE_softshadow-bench"));
    command.args(["--device", "native", "--quick", "--size", "96x64", "--repeats", "1", "--json"]).arg(&json);
    command.args(["--scene", "fork", "--scene", "toruses", "--scene", "cards"]);
    command.args(["--reference", "ray_traced:samples=16,passes=2"]);
    CASES.iter().for_each(|case| {
        command.args(["--technique", case]);
    });
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = std::fs::read_to_string(&json).unwrap();
    std::fs::remove_file(&json).unwrap();
    let lines = text.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    let names = ["bytes_in_all", "submissions", "traced_receivers", "area_receivers", "silhouette_edges"];
    lines
        .map(|line| {
            let mut counts: BTreeMap<String, u64> =
                names.iter().map(|name| ((*name).to_owned(), line[name].as_u64().unwrap())).collect();
            counts.insert("passes".into(), line["pass_ms"].as_array().unwrap().len() as u64);
            // Areas are answers without samples: fewer of them are more work.
            let all = line["valid_receivers"].as_u64().unwrap();
            let by_area = counts.remove("area_receivers").unwrap();
            counts.insert("receivers_without_area".into(), all - by_area.min(all));
            (format!("{} {}", line["scene"].as_str().unwrap(), line["case"].as_str().unwrap()), counts)
        })
        .collect()
}

/// Everything that grew by more than the factor, or is not there any more.
fn grown(kept: &Counts, now: &Counts) -> Vec<String> {
    let mut found = Vec::new();
    for (place, counts) in kept {
        for (name, before) in counts {
            match now.get(place).and_then(|counts| counts.get(name)) {
                None => found.push(format!("{place}: {name} is not counted any more")),
                Some(after) if *after as f64 > FACTOR * *before as f64 => {
                    found.push(format!("{place}: {name} grew from {before} to {after}"));
                }
                Some(_) => {}
            }
        }
    }
    found
}

#[test]
fn no_work_has_grown() {
    let now = counted();
    if std::env::var_os("SOFTSHADOW_KEEP_COUNTS").is_some() {
        std::fs::write(kept_file(), serde_json::to_string_pretty(&now).unwrap() + "\n").unwrap();
    }
    let kept: Counts = serde_json::from_str(&std::fs::read_to_string(kept_file()).unwrap()).unwrap();
    assert_eq!(kept.len(), 3 * CASES.len(), "every case of every scene is kept");
    let grown = grown(&kept, &now);
    assert!(grown.is_empty(), "{}\nmeant so? SOFTSHADOW_KEEP_COUNTS=1 keeps the new counts", grown.join("\n"));
}

#[test]
fn growth_is_seen() {
    let counts = |n: u64| Counts::from([("fork rays".into(), BTreeMap::from([("bytes_in_all".into(), n)]))]);
    assert!(grown(&counts(100), &counts(105)).is_empty() && grown(&counts(100), &counts(7)).is_empty());
    assert_eq!(grown(&counts(100), &counts(106)), ["fork rays: bytes_in_all grew from 100 to 106"]);
    assert_eq!(grown(&counts(0), &counts(1)).len(), 1);
    assert_eq!(grown(&counts(1), &Counts::new()), ["fork rays: bytes_in_all is not counted any more"]);
}
