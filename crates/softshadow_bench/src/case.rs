//! What is measured: a technique with its settings, alone or with a picture, on a scene as it is or half opaque, in the command
//! line's own words.

use std::str::FromStr;

use serde_json::{Map, Value};
use softshadow::{Shading, Technique};

/// `depth-complexity:samples=64,exact_area=true`, with `+integrated` or `+modulated` where the picture counts, too, and with
/// `+semi-opaque` where every triangle lets half of the light pass.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Case {
    /// As it was typed.
    pub(crate) text: String,
    pub(crate) technique: Technique,
    /// How the picture is shaded; without it only visibility is computed.
    pub(crate) picture: Option<Shading>,
    pub(crate) semi_opaque: bool,
}

/// A text that is no case.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(crate) enum CaseError {
    #[error("unknown technique '{name}'; there are {known}")]
    Unknown { name: String, known: String },
    #[error("'{pair}': SETTING=VALUE expected")]
    Pair { pair: String },
    #[error("'{setting}' is given twice")]
    Twice { setting: String },
    #[error("{name}: {reason}")]
    Settings { name: String, reason: String },
    #[error("'+{text}': +integrated, +modulated or +semi-opaque expected, each once")]
    Addition { text: String },
}

impl Case {
    /// Whether both measure the same, however they were typed.
    pub(crate) fn is(&self, other: &Self) -> bool {
        (&self.technique, self.picture, self.semi_opaque) == (&other.technique, other.picture, other.semi_opaque)
    }
}

impl FromStr for Case {
    type Err = CaseError;

    fn from_str(text: &str) -> Result<Self, CaseError> {
        let mut parts = text.split('+');
        let technique = parse_technique(parts.next().unwrap_or_default())?;
        let (mut picture, mut semi_opaque) = (None, false);
        for part in parts {
            let twice = match part.replace('-', "_").as_str() {
                "semi_opaque" => std::mem::replace(&mut semi_opaque, true),
                _ => picture.replace(shading(part)?).is_some(),
            };
            if twice {
                return Err(CaseError::Addition { text: part.into() });
            }
        }
        Ok(Self { text: text.to_owned(), technique, picture, semi_opaque })
    }
}

fn shading(text: &str) -> Result<Shading, CaseError> {
    serde_json::from_value(Value::from(text)).map_err(|_| CaseError::Addition { text: text.into() })
}

/// `ray-traced:samples=64,seed=1`; what is not given has its default. Names and types are those of the settings themselves.
pub(crate) fn parse_technique(text: &str) -> Result<Technique, CaseError> {
    let (name, rest) = text.split_once(':').unwrap_or((text, ""));
    let name = name.replace('-', "_");
    let known: Vec<&str> = Technique::defaults().iter().map(Technique::name).collect();
    if !known.contains(&name.as_str()) {
        return Err(CaseError::Unknown { name, known: known.join(", ") });
    }
    let mut settings = Map::from_iter([("name".to_owned(), Value::from(name.as_str()))]);
    for pair in rest.split(',').filter(|pair| !pair.is_empty()) {
        let (setting, value) = pair.split_once('=').ok_or_else(|| CaseError::Pair { pair: pair.into() })?;
        if settings.insert(setting.to_owned(), read(value)).is_some() {
            return Err(CaseError::Twice { setting: setting.into() });
        }
    }
    let wrong = |reason: String| CaseError::Settings { name: name.clone(), reason };
    let technique: Technique = serde_json::from_value(Value::Object(settings)).map_err(|e| wrong(e.to_string()))?;
    technique.check().map_err(|e| wrong(e.to_string()))?;
    Ok(technique)
}

/// Numbers and truth values as they are, everything else as a word.
fn read(value: &str) -> Value {
    match serde_json::from_str(value) {
        Ok(plain @ (Value::Number(_) | Value::Bool(_))) => plain,
        _ => Value::from(value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use softshadow::{DepthComplexity, RayTraced, SamplePattern};

    #[test]
    fn settings_are_read_by_name_and_type() {
        let case: Case = "depth-complexity:samples=128,exact_area=false,pattern=low_discrepancy".parse().unwrap();
        let settings = DepthComplexity {
            samples: 128,
            exact_area: false,
            pattern: SamplePattern::LowDiscrepancy,
            ..DepthComplexity::default()
        };
        assert_eq!((case.technique, case.picture), (Technique::DepthComplexity(settings), None));
        let case: Case = "ray_traced+modulated".parse().unwrap();
        assert_eq!(case.technique, Technique::RayTraced(RayTraced::default()));
        assert_eq!((case.picture, case.semi_opaque), (Some(Shading::Modulated), false));
        let case: Case = "ray_traced+semi-opaque+integrated".parse().unwrap();
        assert_eq!((case.picture, case.semi_opaque), (Some(Shading::Integrated), true));
    }

    #[test]
    fn one_case_can_be_typed_in_two_ways() {
        let [a, b] =
            ["ray_traced:samples=64", "ray-traced:seed=0,samples=64"].map(|text| text.parse::<Case>().unwrap());
        let [c, d] = ["integrated", "semi_opaque"].map(|addition| format!("ray_traced:samples=64+{addition}"));
        assert!(a.is(&b) && !a.is(&c.parse().unwrap()) && !a.is(&d.parse().unwrap()));
    }

    #[test]
    fn every_default_survives_as_text() {
        for technique in Technique::defaults() {
            let Value::Object(mut settings) = serde_json::to_value(&technique).unwrap() else { panic!() };
            settings.remove("name");
            let word = |v: &Value| v.as_str().map_or_else(|| v.to_string(), str::to_owned);
            let pairs: Vec<String> = settings.iter().map(|(k, v)| format!("{k}={}", word(v))).collect();
            let text = format!("{}:{}", technique.name(), pairs.join(","));
            assert_eq!(parse_technique(&text).unwrap(), technique, "{text}");
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
        let reason = |text: &str| text.parse::<Case>().unwrap_err().to_string();
        assert!(reason("voxels").starts_with("unknown technique 'voxels'; there are ray_traced, "));
        assert_eq!(reason("ray_traced:samples"), "'samples': SETTING=VALUE expected");
        assert_eq!(reason("ray_traced:seed=1,seed=2"), "'seed' is given twice");
        assert_eq!(reason("ray_traced:name=hard_shadow_map"), "'name' is given twice");
        assert!(reason("ray_traced:tries=3").contains("unknown field `tries`"), "{}", reason("ray_traced:tries=3"));
        assert!(reason("ray_traced:samples=many").contains("invalid type: string \"many\""));
        assert!(reason("ray_traced:samples=0").contains("samples"));
        let expected = "expected, each once";
        for wrong in ["ray_traced+painted", "ray_traced+integrated+modulated", "ray_traced+semi-opaque+semi_opaque"] {
            assert!(reason(wrong).ends_with(expected), "{wrong}");
        }
    }
}
