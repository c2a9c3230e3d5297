//! Walks a program as an engine does, with a function in the place of the device.

use std::fmt::Write as _;

use softshadow_plan::{
    Content, Host, Origin, Plan, PlanError, Program, ResourceId, Shape, Stage, Step, TextureFormat, Values, check,
};

/// More stages than any program here has.
const MOST_STAGES: usize = 64;

/// Runs a program to its end. `device` answers a stage with the contents of its decision buffer.
pub(crate) fn walk(program: &dyn Program, mut device: impl FnMut(usize, &Stage) -> Vec<u32>) -> Vec<Stage> {
    let (mut stages, mut decision) = (Vec::new(), Vec::new());
    while let Step::Run(stage) = program.step(stages.len(), &decision) {
        check_values(&stage).unwrap();
        check_resources(&stage.plan).unwrap();
        decision = device(stages.len(), &stage);
        let bytes = stage.plan.decision.map_or(0, |id| stage.plan.resources[id.index()].bytes());
        assert_eq!(decision.len() as u64 * 4, bytes, "the simulated device answers with the whole buffer");
        stages.push(*stage);
        assert!(stages.len() <= MOST_STAGES, "the program does not end");
    }
    stages
}

/// Every parameter has a value of its size, and every value a parameter.
fn check_values(Stage { plan, values }: &Stage) -> Result<(), String> {
    let parameters = plan.resources.iter().filter(|r| r.origin == Origin::Parameter);
    for parameter in parameters.clone() {
        match values.get(&parameter.label) {
            Some(value) if value.len() as u64 == parameter.bytes() => {}
            Some(value) => return Err(format!("'{}' is given {} bytes", parameter.label, value.len())),
            None => return Err(format!("'{}' is given no value", parameter.label)),
        }
    }
    match values.keys().find(|label| !parameters.clone().any(|p| p.label == **label)) {
        Some(label) => Err(format!("'{label}' is no parameter")),
        None => Ok(()),
    }
}

/// What can be said of a plan whose kernels do not exist: labels, shapes, sizes, and where contents come from.
fn check_resources(plan: &Plan) -> Result<(), PlanError> {
    check(&Plan { resources: plan.resources.clone(), ..Plan::new(&*plan.name) }, &Host::default())
}

/// A buffer that the caller filled. What a program does not write itself is undefined in persistent and transient ones.
pub(crate) fn given(plan: &mut Plan, label: &str, bytes: u64) -> ResourceId {
    plan.resource(label, Shape::Buffer { bytes }, Origin::External)
}

/// Some of the stages as text: the plan, and small values as words.
pub(crate) fn text<const N: usize>(stages: &[Stage], which: [usize; N]) -> String {
    let mut text = String::new();
    for index in which {
        let stage = &stages[index];
        write!(text, "stage {index}: {}", stage.plan).unwrap();
        for (label, value) in &stage.values {
            let words: Vec<u32> = value.chunks_exact(4).map(|w| u32::from_le_bytes(w.try_into().unwrap())).collect();
            match words.len() {
                0..=4 => writeln!(text, "  value: {label} = {words:?}").unwrap(),
                _ => writeln!(text, "  value: {label} of {} bytes", value.len()).unwrap(),
            }
        }
    }
    text
}

/// The value of a parameter made of words.
pub(crate) fn words(label: &str, words: &[u32]) -> (String, Vec<u8>) {
    (label.to_owned(), words.iter().flat_map(|w| w.to_le_bytes()).collect())
}

#[test]
fn a_missing_or_foreign_value_is_seen() {
    let mut plan = Plan::new("one parameter");
    plan.parameter("slope", 8);
    let check = |values: Values| check_values(&Stage { plan: plan.clone(), values });
    assert_eq!(check([words("slope", &[1, 2])].into()), Ok(()));
    assert_eq!(check([words("slope", &[1])].into()), Err("'slope' is given 4 bytes".into()));
    assert_eq!(check(Values::new()), Err("'slope' is given no value".into()));
    assert_eq!(check([words("slope", &[1, 2]), words("scale", &[1])].into()), Err("'scale' is no parameter".into()));
}

#[test]
fn resources_that_no_host_makes_are_seen() {
    let mut plan = Plan::new("one image");
    let image = plan.texture("image", TextureFormat::R32Float, [8, 4], Origin::Transient);
    assert_eq!(check_resources(&plan), Ok(()));
    plan.resources[image.index()].origin = Origin::Uploaded(Content::new(&[0; 128]).key);
    assert!(matches!(check_resources(&plan), Err(PlanError::Binding { binding, .. }) if binding == "image"));
}

#[test]
#[should_panic(expected = "the program does not end")]
fn an_endless_program_is_seen() {
    struct Endless;
    impl Program for Endless {
        fn step(&self, _index: usize, _decision: &[u32]) -> Step {
            Step::run(Plan::new("again"), Values::new())
        }
    }
    walk(&Endless, |_, _| Vec::new());
}
