//! Every setting that could serve a call: what it should cost, and how wrong it should be.

use std::sync::Arc;

use serde::Serialize;
use softshadow_plan::PassWork;
use softshadow_scene::Receivers;
use softshadow_techniques::Technique;

use super::calibration::{Calibration, Factors};
use super::{Call, Limit};
use crate::error::Error;
use crate::visibility::{Visibility, work};

/// One setting.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Candidate {
    /// The technique and its settings.
    pub technique: Technique,
    /// Wall time that the plan and the calibration lead to expect.
    pub predicted_ms: f64,
    /// The error that is expected, in the norm of the goal; `None` where nothing is known.
    pub expected_error: Option<f64>,
    /// The error that was measured, by the pilot or a check.
    pub measured_error: Option<f64>,
    /// Wall time of the whole call, where it ran.
    pub wall_ms: Option<f64>,
    /// Why it could not be taken, where it was refused.
    pub refused: Option<String>,
}

impl Candidate {
    /// What is known best.
    pub(super) fn error(&self) -> Option<f64> {
        self.measured_error.or(self.expected_error).filter(|_| self.refused.is_none())
    }
}

/// All settings of all techniques that the device can serve.
pub(super) struct Candidates {
    pub(super) all: Vec<Candidate>,
    /// Work of the call by each, in the same order.
    works: Vec<(Vec<PassWork>, usize)>,
    model: Arc<Calibration>,
    /// Where the costs come from.
    pub(super) calibration: String,
}

/// Where no technique can serve a call.
pub(super) fn none() -> Error {
    Error::Settings("max_error: no technique that can be chosen serves this scene on this device; name one".into())
}

impl Candidates {
    pub(super) fn of(call: &Call<'_>) -> Result<Self, Error> {
        let (model, calibration) = call.device.calibration()?;
        let (mut all, mut works) = (Vec::new(), Vec::new());
        let mut first_refusal = None;
        for technique in Technique::defaults().iter().flat_map(Technique::rising_quality) {
            let found = work(call.device, call.scene, call.lights, call.receivers, &technique);
            let (work, refused) = match found {
                Ok(work) => (work, None),
                Err(error @ (Error::Settings(_) | Error::TooLarge { .. } | Error::Scene(_))) => {
                    let reason = error.to_string();
                    first_refusal.get_or_insert(error);
                    ((Vec::new(), 0), Some(reason))
                }
                Err(error) => return Err(error),
            };
            let expected_error = technique.expected_error().map(|rmse| rmse * call.goal.over_rmse());
            all.push(Candidate {
                technique,
                predicted_ms: 0.0,
                expected_error,
                measured_error: None,
                wall_ms: None,
                refused,
            });
            works.push(work);
        }
        if let Some(error) =
            first_refusal.filter(|_| all.iter().all(|candidate: &Candidate| candidate.refused.is_some()))
        {
            return Err(error);
        }
        let mut candidates = Self { all, works, model, calibration };
        candidates.predict(call);
        Ok(candidates)
    }

    /// Costs of all, with what is known by now about this scene.
    pub(super) fn predict(&mut self, call: &Call<'_>) {
        for (candidate, (work, stages)) in self.all.iter_mut().zip(&self.works) {
            let factors = call.device.factors(call.scene, candidate.technique.name());
            candidate.predicted_ms = self.model.ms(&candidate.technique, work, *stages, call.receivers, &factors);
        }
    }

    /// Cost of one for other receivers, with what is known by now.
    pub(super) fn predicted_for(&self, call: &Call<'_>, index: usize, receivers: &Receivers) -> Result<f64, Error> {
        let technique = &self.all[index].technique;
        let (work, stages) = work(call.device, call.scene, call.lights, receivers, technique)?;
        let factors = call.device.factors(call.scene, technique.name());
        Ok(self.model.ms(technique, &work, stages, receivers, &factors))
    }

    /// Takes in what a run has shown about costs on this scene.
    pub(super) fn learn(&mut self, call: &Call<'_>, index: usize, receivers: &Receivers, result: &Visibility) {
        let technique = &self.all[index].technique;
        let Ok((work, stages)) = work(call.device, call.scene, call.lights, receivers, technique) else { return };
        let factors: Factors = self.model.factors(technique, &work, stages, receivers, &result.info);
        call.device.learn(call.scene, technique.name(), factors);
        if receivers == call.receivers {
            self.all[index].wall_ms = Some(result.info.wall_ms);
        }
        self.predict(call);
    }

    /// Takes in an error that was measured. Others of the technique whose errors follow from their samples err as much more or less than
    /// expected.
    pub(super) fn measured(&mut self, index: usize, error: f64) {
        self.all[index].measured_error = Some(error);
        let Candidate { technique, .. } = &self.all[index];
        let (name, Some(law)) = (technique.name(), technique.expected_error()) else { return };
        for other in self.all.iter_mut().filter(|other| other.technique.name() == name) {
            if let Some(rmse) = other.technique.expected_error() {
                other.expected_error = Some(rmse * error / law);
            }
        }
    }

    pub(super) fn refuse(&mut self, index: usize, error: &Error) {
        self.all[index].refused = Some(error.to_string());
    }

    /// Those that may be taken and have not run yet.
    fn open(&self) -> impl Iterator<Item = (usize, &Candidate)> {
        self.all.iter().enumerate().filter(|(_, c)| c.refused.is_none() && c.wall_ms.is_none())
    }

    /// What the fastest should take.
    pub(super) fn least_predicted(&self) -> f64 {
        self.fastest().map_or(0.0, |candidate| candidate.predicted_ms)
    }

    pub(super) fn fastest(&self) -> Option<&Candidate> {
        self.open().map(|(_, c)| c).min_by(|a, b| a.predicted_ms.total_cmp(&b.predicted_ms))
    }

    /// The fastest of those that are expected to err by no more.
    pub(super) fn fastest_within(&self, error: f64) -> Option<usize> {
        let good = self.open().filter(|(_, c)| c.error().is_some_and(|e| e <= error));
        good.min_by(|a, b| a.1.predicted_ms.total_cmp(&b.1.predicted_ms)).map(|(index, _)| index)
    }

    /// The best of those that are expected to take no longer.
    pub(super) fn best_within(&self, ms: f64) -> Option<usize> {
        let fast = self.open().filter(|(_, c)| c.predicted_ms <= ms);
        let known = fast.filter_map(|(index, c)| Some((index, c.error()?)));
        known.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(index, _)| index)
    }

    /// What comes closest to a limit that nothing keeps.
    pub(super) fn nearest(&self, limit: Limit) -> Option<usize> {
        let known = self.open().filter_map(|(index, c)| Some((index, c, c.error()?)));
        match limit {
            Limit::MaxError(_) => known.min_by(|a, b| a.2.total_cmp(&b.2)).map(|(index, ..)| index),
            Limit::MaxMs(_) => {
                known.min_by(|a, b| a.1.predicted_ms.total_cmp(&b.1.predicted_ms)).map(|(index, ..)| index)
            }
        }
    }

    /// Names of techniques, and the fastest setting of each within an error; those of unknown error by their first setting.
    pub(super) fn of_each_technique(&self, error: f64) -> Vec<usize> {
        let mut names: Vec<&str> = Vec::new();
        for (_, candidate) in self.open() {
            if !names.contains(&candidate.technique.name()) {
                names.push(candidate.technique.name());
            }
        }
        let of = |name: &str| {
            let own = || self.open().filter(|(_, c)| c.technique.name() == name);
            let good = own().filter(|(_, c)| c.error().is_some_and(|e| e <= error));
            let fastest = good.min_by(|a, b| a.1.predicted_ms.total_cmp(&b.1.predicted_ms));
            fastest.or_else(|| own().find(|(_, c)| c.error().is_none())).map(|(index, _)| index)
        };
        let mut found: Vec<usize> = names.into_iter().filter_map(of).collect();
        found.sort_by(|a, b| self.all[*a].predicted_ms.total_cmp(&self.all[*b].predicted_ms));
        found
    }

    /// As a result tells them.
    pub(super) fn listed(&self) -> Vec<Candidate> {
        let mut listed = self.all.clone();
        listed.sort_by(|a, b| a.predicted_ms.total_cmp(&b.predicted_ms));
        listed
    }
}
