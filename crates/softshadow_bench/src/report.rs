//! What is said about measurements: aligned tables for people, JSON lines for machines.

use serde::Serialize;
use softshadow::measure::{ErrorReport, RegionError};
use softshadow::{AdapterInfo, DeviceKind, PassTime, Shading, Technique};

use crate::measure::Measurement;
use crate::statistics::{median, range};
use crate::table::Table;

/// What every number depends on.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Environment {
    pub(crate) version: &'static str,
    pub(crate) adapter: AdapterInfo,
    pub(crate) system: String,
    /// Threads that the machine runs at once.
    pub(crate) threads: usize,
}

impl Environment {
    pub(crate) fn of(adapter: &AdapterInfo) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            adapter: adapter.clone(),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
        }
    }

    /// What makes these numbers worth less.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let software = (self.adapter.device_type == DeviceKind::Software).then(|| {
            format!("'{}' is a software driver: its times say nothing about a graphics card", self.adapter.name)
        });
        let build = cfg!(debug_assertions).then(|| "this is a debug build".to_owned());
        software.into_iter().chain(build).collect()
    }

    pub(crate) fn line(&self) -> String {
        let AdapterInfo { name, backend, driver, .. } = &self.adapter;
        let kind = format!("{:?}", self.adapter.device_type).to_lowercase();
        let (version, system, threads) = (self.version, &self.system, self.threads);
        format!("softshadow {version}, {name}, {backend}, {kind}, {driver}; {system}, {threads} threads")
    }
}

/// One line of JSON: everything that is known about one case on one scene.
#[derive(Debug, Serialize)]
pub(crate) struct Row<'a> {
    kind: &'static str,
    scene: &'a str,
    size: [u32; 2],
    case: &'a str,
    technique: &'a Technique,
    picture: Option<Shading>,
    semi_opaque: bool,
    median_wall_ms: f64,
    range_wall_ms: [f64; 2],
    wall_ms: &'a [f64],
    median_call_ms: f64,
    call_ms: &'a [f64],
    pass_ms: &'a [PassTime],
    /// Of the run in which passes were timed.
    pass_run_wall_ms: f64,
    /// Share of that wall time that the passes explain.
    pass_share: f64,
    bytes_in_all: u64,
    bytes: &'a [(String, u64)],
    errors: &'a ErrorReport,
    reference: &'a Technique,
    reference_standard_error: Option<f64>,
    receivers: usize,
    valid_receivers: Option<usize>,
    traced_receivers: u64,
    area_receivers: u64,
    silhouette_edges: u64,
    submissions: usize,
    environment: &'a Environment,
}

/// Where a measurement belongs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place<'a> {
    pub(crate) scene: &'a str,
    pub(crate) size: [u32; 2],
    pub(crate) reference: &'a Technique,
    pub(crate) reference_standard_error: Option<f64>,
    pub(crate) environment: &'a Environment,
}

impl<'a> Row<'a> {
    pub(crate) fn of(place: Place<'a>, m: &'a Measurement) -> Self {
        Self {
            kind: "measurement",
            scene: place.scene,
            size: place.size,
            case: &m.case.text,
            technique: &m.case.technique,
            picture: m.case.picture,
            semi_opaque: m.case.semi_opaque,
            median_wall_ms: m.median_ms(),
            range_wall_ms: range(&m.wall_ms),
            wall_ms: &m.wall_ms,
            median_call_ms: median(&m.call_ms),
            call_ms: &m.call_ms,
            pass_ms: &m.passes.pass_ms,
            pass_run_wall_ms: m.passes.wall_ms,
            pass_share: m.passes.explained(),
            bytes_in_all: m.bytes(),
            bytes: &m.info.bytes,
            errors: &m.errors,
            reference: place.reference,
            reference_standard_error: place.reference_standard_error,
            receivers: m.info.receivers,
            valid_receivers: m.info.valid_receivers,
            traced_receivers: m.info.traced_receivers,
            area_receivers: m.info.area_receivers,
            silhouette_edges: m.info.silhouette_edges,
            submissions: m.info.submissions,
            environment: place.environment,
        }
    }
}

/// Time, memory and error, a line each; other tables name cases by their number here.
pub(crate) fn summary(measurements: &[Measurement]) -> Table {
    let header = "#|case|ms|from|to|call ms|MiB|penumbra RMSE|MAE|p99|max|bias|all RMSE|MAE|p99|max|bias|> 0.25|passes";
    let mut table = Table::new(2, header.split('|'));
    for (index, m) in measurements.iter().enumerate() {
        let [low, high] = range(&m.wall_ms);
        let mut row = vec![format!("{}", index + 1), m.case.text.clone()];
        row.extend([m.median_ms(), low, high, median(&m.call_ms)].map(|ms| format!("{ms:.1}")));
        row.push(format!("{:.1}", m.bytes() as f64 / f64::from(1 << 20)));
        row.extend(error_cells(m.errors.penumbra));
        row.extend(error_cells(m.errors.overall));
        row.extend([m.errors.gross_count.to_string(), format!("{:.0} %", 100.0 * m.passes.explained())]);
        table.add(row);
    }
    table
}

/// A slowest turn beyond so many medians is another program's work.
const NOISE: f64 = 1.5;

/// Which cases had other work beside them.
pub(crate) fn noise(measurements: &[Measurement]) -> Option<String> {
    let is_noisy = |m: &&Measurement| range(&m.wall_ms)[1] > NOISE * m.median_ms();
    let count = measurements.iter().filter(is_noisy).count();
    (count > 0).then(|| {
        let of = measurements.len();
        format!("{count} of {of} cases had a turn of more than {NOISE} times their median: the machine has other work")
    })
}

/// Nothing measured never reads as no error.
fn error_cells(region: Option<RegionError>) -> [String; 5] {
    region.map_or([(); 5].map(|()| "-".to_owned()), |r| {
        let [rmse, mae, p99, max] = [r.rmse, r.mae, r.p99, r.max].map(|x| format!("{x:.4}"));
        [rmse, mae, p99, max, format!("{:+.4}", r.bias)]
    })
}

/// Milliseconds by pass, a column a case; every pass had a submission of its own.
pub(crate) fn passes(measurements: &[Measurement]) -> Table {
    let cells = |m: &Measurement| m.passes.pass_ms.iter().map(|p| (p.label.clone(), format!("{:.2}", p.ms))).collect();
    let mut table = by_label("pass", measurements, cells);
    let last = |name: &str, of: fn(&Measurement) -> f64| {
        [name.to_owned()].into_iter().chain(measurements.iter().map(|m| format!("{:.2}", of(m)))).collect::<Vec<_>>()
    };
    table.add(last("all passes", |m| m.passes.pass_ms.iter().map(|pass| pass.ms).sum()));
    table.add(last("wall time of that run", |m| m.passes.wall_ms));
    table
}

/// Bytes by resource, a column a case, as the plan counts them.
pub(crate) fn bytes(measurements: &[Measurement]) -> Table {
    let cells = |m: &Measurement| m.info.bytes.iter().map(|(l, bytes)| (l.clone(), bytes.to_string())).collect();
    let mut table = by_label("bytes", measurements, cells);
    table.add(["in all".to_owned()].into_iter().chain(measurements.iter().map(|m| m.bytes().to_string())));
    table
}

/// A column a case, a row for every label that any of them has.
fn by_label(title: &str, measurements: &[Measurement], of: impl Fn(&Measurement) -> Vec<(String, String)>) -> Table {
    let columns: Vec<Vec<(String, String)>> = measurements.iter().map(of).collect();
    let header = [title.to_owned()].into_iter().chain((1..=columns.len()).map(|n| format!("#{n}")));
    let mut table = Table::new(1, header);
    let mut labels: Vec<&str> = Vec::new();
    for (label, _) in columns.iter().flatten() {
        if !labels.contains(&label.as_str()) {
            labels.push(label);
        }
    }
    for label in labels {
        let cell = |column: &Vec<(String, String)>| {
            column.iter().find(|(known, _)| known == label).map_or_else(String::new, |(_, cell)| cell.clone())
        };
        table.add([label.to_owned()].into_iter().chain(columns.iter().map(cell)));
    }
    table
}
