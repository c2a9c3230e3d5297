//! Calibrations are kept in a folder: found again, made anew where they are spoilt, and done without where there is no folder. A binary of its
//! own: it sets a variable of the process.

use softshadow::measure::ErrorNorm;
use softshadow::{
    Camera, Context, DeviceChoice, Goal, Light, LightShape, Options, Receivers, look_at, procedural, visibility_within,
};

/// Where the costs came from, in a context that knows none.
fn calibration() -> String {
    let described = procedural::shipped("cards").unwrap();
    let pose = look_at([0.0, 4.0, 0.0], [0.0; 3], Some([1.0, 0.0, 0.0])).unwrap();
    let light = Light::new(LightShape::Rectangle { width: 1.0, height: 1.0 }, pose).unwrap();
    let camera = Camera::look_at([3.0, 3.0, 3.0], [0.0; 3], None, 40.0, [8, 6]).unwrap();
    let context = Context::new(&DeviceChoice::Native).unwrap();
    let (scene, goal) = (described.build().unwrap(), Goal::max_error(0.3, ErrorNorm::Rmse));
    let receivers = Receivers::Camera(camera);
    let seen = visibility_within(&context, &scene, &[light], &receivers, &goal, &Options::default(), &mut |_, _| true)
        .unwrap();
    seen.info.choice.unwrap().calibration
}

#[test]
#[expect(unsafe_code, reason = "the variable is set before any other thread of this process runs")]
fn what_a_device_needs_is_measured_once_and_kept() {
    let folder = std::env::temp_dir().join(format!("softshadow-calibration-{}", std::process::id()));
    let set = |value: &std::path::Path| {
        // SAFETY: this is the only test of the binary, and no other thread reads the environment now.
        unsafe { std::env::set_var("SOFTSHADOW_CACHE", value) }
    };
    set(&folder);
    assert_eq!(calibration(), "made, and kept");
    let files = || std::fs::read_dir(&folder).unwrap().map(|file| file.unwrap().path()).collect::<Vec<_>>();
    let [file] = &files()[..] else { panic!("one file, and none half written: {:?}", files()) };
    assert_eq!(calibration(), "kept from an earlier process");

    let kept = std::fs::read_to_string(file).unwrap();
    std::fs::write(file, &kept[..kept.len() / 2]).unwrap();
    let anew = calibration();
    assert!(anew.starts_with("made anew (EOF") && anew.ends_with(", and kept"), "{anew}");
    assert_eq!(calibration(), "kept from an earlier process");

    set(std::path::Path::new("off"));
    assert_eq!(calibration(), "made, and not kept");
    // A file where the folder should be.
    set(file);
    let unkept = calibration();
    assert!(unkept.contains(", and not kept ("), "{unkept}");
    std::fs::remove_dir_all(&folder).unwrap();
}
