//! How settings name a pattern of samples.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serializer};
use softshadow_scene::SamplePattern;

const NAMES: [(&str, SamplePattern); 2] =
    [("stratified", SamplePattern::Stratified), ("low_discrepancy", SamplePattern::LowDiscrepancy)];

pub(crate) fn serialize<S: Serializer>(pattern: &SamplePattern, serializer: S) -> Result<S::Ok, S::Error> {
    let name = NAMES.iter().find(|(_, p)| p == pattern).map_or("", |(name, _)| name);
    serializer.serialize_str(name)
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<SamplePattern, D::Error> {
    let name = String::deserialize(deserializer)?;
    let found = NAMES.iter().find(|(n, _)| *n == name).map(|(_, pattern)| *pattern);
    found.ok_or_else(|| D::Error::custom(format!("pattern '{name}' is neither 'stratified' nor 'low_discrepancy'")))
}
