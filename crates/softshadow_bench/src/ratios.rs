//! The papers' own tables, and what we ask of ourselves, as ratios of two cases that take turns. Another ratio is another row of
//! [`RATIOS`]; its cases are measured by being named there.

use clap::ValueEnum;
use serde::Serialize;

use crate::case::{Case, CaseError};
use crate::measure::Measurement;
use crate::statistics::{median, range};
use crate::table::Table;

/// The time of one case over that of another.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Ratio {
    name: &'static str,
    over: &'static str,
    under: &'static str,
    /// What is asked of us.
    asked: &'static str,
    /// What Forest, Barthe and Paulin (2008) publish; empty where they do not.
    published: &'static str,
}

const fn asked(name: &'static str, over: &'static str, under: &'static str, asked: &'static str) -> Ratio {
    Ratio { name, over, under, asked, published: "" }
}

const fn published(name: &'static str, over: &'static str, under: &'static str, published: &'static str) -> Ratio {
    Ratio { name, over, under, asked: "", published }
}

/// Which ratios are measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Chosen {
    /// Every row
    All,
    /// Rows that a paper has, too
    Published,
}

impl Chosen {
    fn has(self, ratio: &Ratio) -> bool {
        self == Self::All || !ratio.published.is_empty()
    }
}

const FOREST: &str = "depth_complexity:samples=64,exact_area=false";

pub(crate) const RATIOS: &[Ratio] = &[
    Ratio {
        asked: "< 2",
        ..published("64 : 16 samples", FOREST, "depth_complexity:samples=16,exact_area=false", "about 5")
    },
    Ratio {
        asked: "< 3",
        ..published("256 : 64 samples", "depth_complexity:samples=256,exact_area=false", FOREST, "no figure")
    },
    published(
        "table : exact coverage",
        "depth_complexity:samples=64,exact_area=false,coverage=table",
        FOREST,
        "0.67 to 0.75",
    ),
    published(
        "interleaved : correlated",
        "depth_complexity:samples=64,exact_area=false,spread=interleaved",
        FOREST,
        "about 1",
    ),
    published("semi-opaque : opaque", "depth_complexity:samples=64,exact_area=false+semi-opaque", FOREST, "below 1.04"),
    published(
        "integrated : modulated",
        "depth_complexity:samples=64+integrated",
        "depth_complexity:samples=64+modulated",
        "1.08 to 1.12",
    ),
    asked(
        "standard : accurate silhouettes",
        "depth_complexity:samples=64,exact_area=false,silhouettes=standard",
        FOREST,
        "fewer edges, wrong penumbrae",
    ),
    asked(
        "blended : tiled",
        "depth_complexity:samples=64,exact_area=false,evaluation=blended,counters=words",
        FOREST,
        "",
    ),
    asked(
        "float : words",
        "depth_complexity:samples=64,exact_area=false,evaluation=blended,counters=float",
        "depth_complexity:samples=64,exact_area=false,evaluation=blended,counters=words",
        "",
    ),
    asked("areas : samples", "depth_complexity:samples=64", FOREST, "about 1"),
    asked("edges : rays", "depth_complexity:samples=64", "ray_traced:samples=64", ""),
    asked("edges : rays", "depth_complexity:samples=256", "ray_traced:samples=256", ""),
    asked("soft : hard", "depth_complexity:samples=64", "hard_shadow_map", "< 2 at RMSE 0.01"),
];

/// Every case that a chosen ratio names, once.
pub(crate) fn cases(chosen: Chosen) -> Result<Vec<Case>, CaseError> {
    let mut cases: Vec<Case> = Vec::new();
    for text in RATIOS.iter().filter(|ratio| chosen.has(ratio)).flat_map(|ratio| [ratio.under, ratio.over]) {
        add_case(&mut cases, text.parse()?);
    }
    Ok(cases)
}

/// Adds a case that is not among them yet.
pub(crate) fn add_case(cases: &mut Vec<Case>, case: Case) {
    if !cases.iter().any(|known| known.is(&case)) {
        cases.push(case);
    }
}

/// A ratio as it was measured.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct MeasuredRatio {
    #[serde(flatten)]
    pub(crate) ratio: Ratio,
    /// Of the ratios of each turn.
    pub(crate) median: f64,
    pub(crate) range: [f64; 2],
    /// Root mean square error in the penumbra, over and under.
    pub(crate) penumbra_rmse: [Option<f64>; 2],
}

/// Those chosen ratios of which both cases were measured.
pub(crate) fn of(measurements: &[Measurement], chosen: Chosen) -> Result<Vec<MeasuredRatio>, CaseError> {
    let mut found = Vec::new();
    for ratio in RATIOS.iter().filter(|ratio| chosen.has(ratio)) {
        let (over, under): (Case, Case) = (ratio.over.parse()?, ratio.under.parse()?);
        let measured = |case: &Case| measurements.iter().find(|m| m.case.is(case));
        if let (Some(over), Some(under)) = (measured(&over), measured(&under)) {
            // Turn by turn: what slows the machine down slows both.
            let turns: Vec<f64> = over.wall_ms.iter().zip(&under.wall_ms).map(|(a, b)| a / b).collect();
            let rmse = |m: &Measurement| m.errors.penumbra.map(|region| region.rmse);
            found.push(MeasuredRatio {
                ratio: *ratio,
                median: median(&turns),
                range: range(&turns),
                penumbra_rmse: [rmse(over), rmse(under)],
            });
        }
    }
    Ok(found)
}

/// One line a ratio.
pub(crate) fn table(ratios: &[MeasuredRatio]) -> Table {
    let header = "ratio|time of|over that of|published|asked|median|from|to|RMSE of|over";
    let mut table = Table::new(5, header.split('|'));
    for MeasuredRatio { ratio, median, range: [low, high], penumbra_rmse } in ratios {
        let [over, under] = penumbra_rmse.map(|rmse| rmse.map_or("-".into(), |rmse| format!("{rmse:.4}")));
        let words = [ratio.name, ratio.over, ratio.under, ratio.published, ratio.asked].map(str::to_owned);
        let numbers = [median, low, high].map(|x| format!("{x:.2}"));
        table.add(words.into_iter().chain(numbers).chain([over, under]));
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_can_be_measured() {
        let cases = cases(Chosen::All).unwrap();
        let published = super::cases(Chosen::Published).unwrap();
        assert!(published.len() >= 7 && published.len() < cases.len());
        assert!(published.iter().all(|case| cases.iter().any(|known| known.is(case))));
        for ratio in RATIOS {
            let [over, under] = [ratio.over, ratio.under].map(|text| text.parse::<Case>().unwrap());
            assert!(!over.is(&under), "{}", ratio.name);
        }
        for (index, case) in cases.iter().enumerate() {
            assert!(!cases[..index].iter().any(|earlier| earlier.is(case)), "{} is measured once", case.text);
        }
    }
}
