//! Closed forms against the exact union, against Monte Carlo and against other closed forms.

use std::f64::consts::PI;

use softshadow_measure::{
    AxisRectangle, MeasureError, Receiver, Sphere, disc_over_disc, half_plane_over_rectangle, rectangle_over_rectangle,
    rectangle_visibility, sphere_over_rectangle, sphere_over_sphere_light,
};

use crate::random::Random;
use crate::shapes::{LIGHT, as_light, rectangle};

const ORIGIN: [f64; 3] = [0.0; 3];

/// The half-plane n·x < distance as a huge square at height 1 under the light at height 3, seen from the origin.
fn half_plane_mesh(distance: f64, angle: f64) -> [softshadow_measure::Triangle; 2] {
    const FAR: f64 = 50.0;
    let (sin, cos) = angle.sin_cos();
    let at = |along: f64, across: f64| {
        let [x, y] = [cos * along - sin * across, sin * along + cos * across];
        [x / 3.0, y / 3.0, 1.0]
    };
    let corners = [at(distance, -FAR), at(distance, FAR), at(distance - FAR, FAR), at(distance - FAR, -FAR)];
    [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]]
}

#[test]
fn half_planes_agree_with_the_exact_union() {
    let mut random = Random::new(1);
    let (mut worst, mut spoilt) = (0.0_f64, 0);
    for round in 0..500 {
        let shape = AxisRectangle { x: [-0.5, 0.5], y: [-0.2, 0.2], z: 3.0 };
        // Every tenth edge is nearly axis aligned, where the corner formula would cancel.
        let angle = if round % 10 == 0 {
            f64::from(round / 10) * PI / 2.0 + 1e-9 * random.unit()
        } else {
            random.between(0.0, 2.0 * PI)
        };
        let distance = random.between(-0.6, 0.6);
        let formula = half_plane_over_rectangle(distance, angle, [0.5, 0.2]).unwrap();
        let measure = |distance: f64| {
            let mesh = half_plane_mesh(distance, angle);
            rectangle_visibility(&as_light(&shape), &mesh, &Receiver::at(ORIGIN)).unwrap()
        };
        worst = worst.max((formula - measure(distance)).abs());
        spoilt += usize::from((formula - measure(distance + 1e-3)).abs() > 1e-5);
    }
    println!("half-plane: closed form - exact union = {worst:.1e}");
    assert!(worst < 1e-12, "{worst}");
    assert!(spoilt > 200, "a shift by 1e-3 was seen only {spoilt} times");
}

#[test]
fn rectangles_agree_with_the_exact_union() {
    let mut random = Random::new(2);
    let (mut worst, mut spoilt) = (0.0_f64, 0);
    for _ in 0..500 {
        let receiver = [random.between(-0.7, 0.7), random.between(-0.7, 0.7), 0.0];
        let occluder =
            AxisRectangle { x: random.range(-0.5, 0.5), y: random.range(-0.5, 0.5), z: random.between(0.05, 2.9) };
        let measure = |shift: f64| {
            let shifted = AxisRectangle { x: occluder.x.map(|x| x + shift), ..occluder };
            let seen_by = Receiver::at(receiver);
            rectangle_visibility(&as_light(&LIGHT), &rectangle(&shifted), &seen_by).unwrap()
        };
        let formula = rectangle_over_rectangle(receiver, &occluder, &LIGHT).unwrap();
        worst = worst.max((formula - measure(0.0)).abs());
        spoilt += usize::from((formula - measure(1e-3)).abs() > 1e-5);
    }
    println!("rectangle: closed form - exact union = {worst:.1e}");
    assert!(worst < 1e-12, "{worst}");
    assert!(spoilt > 100, "a shift by 1e-3 was seen only {spoilt} times");
}

#[test]
fn discs_agree_with_strips() {
    // Independent: the lens as a sum of thin horizontal strips, each the overlap of two chords.
    let strips = |d: f64, r: f64, big_r: f64| {
        const COUNT: u32 = 200_000;
        let chord = |radius: f64, y: f64| (radius * radius - y * y).max(0.0).sqrt();
        let hidden: f64 = (0..COUNT)
            .map(|k| {
                let y = big_r * (2.0 * (f64::from(k) + 0.5) / f64::from(COUNT) - 1.0);
                let (half, other) = (chord(big_r, y), chord(r, y));
                (half.min(d + other) - (-half).max(d - other)).max(0.0)
            })
            .sum();
        1.0 - hidden * 2.0 * big_r / f64::from(COUNT) / (PI * big_r * big_r)
    };
    let mut random = Random::new(3);
    for round in 0..40 {
        let (r, big_r) = (random.between(0.1, 1.5), random.between(0.5, 1.0));
        let d = match round % 4 {
            0 => (r - big_r).abs() * random.unit(),
            1 => r + big_r + random.unit(),
            _ => random.between((r - big_r).abs(), r + big_r),
        };
        let formula = disc_over_disc(d, r, big_r).unwrap();
        // Where the other disc's chord vanishes inside the light the strips are only good to the 3/2 power of their width.
        assert!((formula - strips(d, r, big_r)).abs() < 1e-6, "{d} {r} {big_r}");
        if round % 4 > 1 {
            assert!((formula - strips(d + 1e-3, r, big_r)).abs() > 1e-6);
        }
    }
}

/// Monte Carlo visibility with its standard error; `hits` says whether a direction meets the occluder.
fn monte_carlo(mut sample: impl FnMut() -> [f64; 3], hits: impl Fn([f64; 3]) -> bool) -> [f64; 2] {
    const COUNT: u32 = 2_000_000;
    let visible = (0..COUNT).filter(|_| !hits(sample())).count() as f64 / f64::from(COUNT);
    let variance = visible * (1.0 - visible) / f64::from(COUNT);
    [visible, variance.sqrt()]
}

/// Whether the ray from the origin meets a ball, by its distance from the centre.
fn meets_ball(direction: [f64; 3], ball: &Sphere) -> bool {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let along = dot(direction, ball.center) / dot(direction, direction);
    let nearest: [f64; 3] = std::array::from_fn(|k| along * direction[k] - ball.center[k]);
    along > 0.0 && dot(nearest, nearest) < ball.radius * ball.radius
}

fn ball(center: [f64; 3], radius: f64) -> Sphere {
    Sphere { center, radius }
}

#[test]
fn a_sphere_over_a_rectangle_agrees_with_monte_carlo() {
    let mut random = Random::new(4);
    let occluders = [
        ball([0.1, 0.2, 1.0], 0.15),
        ball([0.0, 0.0, 0.16], 0.0075),
        ball([0.3, 0.0, 2.0], 0.05),
        ball([0.35, -0.3, 2.0], 0.3),
        ball([0.02, 0.03, 0.5], 0.08),
    ];
    for occluder in occluders {
        let exact = sphere_over_rectangle(ORIGIN, &occluder, &LIGHT).unwrap();
        let [mean, error] =
            monte_carlo(|| [random.between(-0.5, 0.5), random.between(-0.5, 0.5), 3.0], |d| meets_ball(d, &occluder));
        assert!(exact > 0.0 && exact < 1.0);
        assert!((exact - mean).abs() < 3.5 * error, "{exact} {mean} {error}");
        let grown = ball(occluder.center, occluder.radius * 1.02);
        let spoilt = sphere_over_rectangle(ORIGIN, &grown, &LIGHT).unwrap();
        assert!((spoilt - mean).abs() > 3.5 * error, "2 % larger: not seen");
    }
}

#[test]
fn a_sphere_over_a_rectangle_is_continuous_and_symmetric() {
    let visibility =
        |center: [f64; 3], light: &AxisRectangle| sphere_over_rectangle(ORIGIN, &ball(center, 0.1), light).unwrap();
    // Swapping x and y integrates the same conic along the other axis.
    let mut random = Random::new(5);
    let mut worst = 0.0_f64;
    for _ in 0..300 {
        let [x, y] = [random.between(-0.6, 0.6), random.between(-0.6, 0.6)];
        let z = random.between(0.2, 2.8);
        let (here, there) = (visibility([x, y, z], &LIGHT), visibility([y, x, z], &LIGHT));
        worst = worst.max((here - there).abs());
        // Below the light looking up is above the light looking down.
        let below = AxisRectangle { z: -3.0, ..LIGHT };
        assert!((here - visibility([x, y, -z], &below)).abs() < 1e-15);
    }
    println!("sphere over rectangle: along x - along y = {worst:.1e}");
    assert!(worst < 1e-11, "{worst}");
    // The whole light is inside the shadow; the sphere is behind, beyond, partly beyond, around the receiver.
    let small = AxisRectangle { x: [-0.01, 0.01], y: [-0.01, 0.01], z: 3.0 };
    assert!(visibility([0.0, 0.0, 1.0], &small) < 1e-15);
    assert_eq!(visibility([0.0, 0.0, -1.0], &LIGHT), 1.0);
    assert_eq!(visibility([0.0, 0.0, 3.2], &LIGHT), 1.0);
    for center in [[0.0, 0.0, 2.95], [0.5, 0.0, 0.05], [0.0, 0.0, 0.0]] {
        assert!(matches!(
            sphere_over_rectangle(ORIGIN, &ball(center, 0.1), &LIGHT),
            Err(MeasureError::OutsideDomain { .. })
        ));
    }
}

/// Overlap of two caps over the first (Tovchigrechko and Vakser 2001), for caps that cross.
fn overlap_by_formula(first: f64, second: f64, apart: f64) -> f64 {
    let angle = |a: f64, b: f64, c: f64| ((c.cos() - a.cos() * b.cos()) / (a.sin() * b.sin())).clamp(-1.0, 1.0).acos();
    let overlap = 2.0
        * (PI
            - angle(first, second, apart)
            - angle(apart, first, second) * first.cos()
            - angle(apart, second, first) * second.cos());
    overlap / (2.0 * PI * (1.0 - first.cos()))
}

#[test]
fn a_sphere_over_a_spherical_light_agrees_with_the_overlap_of_caps() {
    let light = ball([0.0, 0.0, 3.0], 0.9);
    let mut random = Random::new(6);
    let (mut worst, mut compared, mut spoilt) = (0.0_f64, 0, 0);
    for _ in 0..500 {
        let occluder = ball([random.between(-0.4, 0.4), random.between(-0.4, 0.4), 1.0], random.between(0.05, 0.5));
        let visible = sphere_over_sphere_light(ORIGIN, &occluder, &light).unwrap();
        let distance = occluder.center.iter().map(|x| x * x).sum::<f64>().sqrt();
        let (first, second) = (0.3_f64.asin(), (occluder.radius / distance).asin());
        let apart = (1.0 / distance).acos();
        if apart < first + second && apart > (first - second).abs() {
            let formula = 1.0 - overlap_by_formula(first, second, apart);
            let shifted = 1.0 - overlap_by_formula(first, second, apart + 1e-3);
            worst = worst.max((visible - formula).abs());
            compared += 1;
            spoilt += usize::from((visible - shifted).abs() > 1e-6);
        } else if apart > first + second {
            assert_eq!(visible, 1.0);
        } else {
            let inner = second.min(first).cos();
            let formula = 1.0 - (1.0 - inner) / (1.0 - first.cos());
            assert!((visible - formula).abs() < 1e-11, "{visible} {formula}");
        }
    }
    println!("sphere light: quadrature - cap formula = {worst:.1e}");
    assert!(compared > 100 && worst < 1e-11, "{compared} {worst}");
    assert!(spoilt > compared * 9 / 10, "{spoilt} of {compared}");
}

#[test]
fn a_sphere_over_a_spherical_light_agrees_with_monte_carlo() {
    let light = ball([0.0, 0.0, 3.0], 0.3);
    let occluder = ball([0.1, 0.0, 1.5], 0.1);
    let exact = sphere_over_sphere_light(ORIGIN, &occluder, &light).unwrap();
    let mut random = Random::new(7);
    let lowest = (1.0 - 0.1_f64 * 0.1).sqrt();
    let [mean, error] = monte_carlo(
        || {
            let cosine = random.between(lowest, 1.0);
            let (sin, cos) = random.between(0.0, 2.0 * PI).sin_cos();
            let sine = (1.0 - cosine * cosine).sqrt();
            [sine * cos, sine * sin, cosine]
        },
        |d| meets_ball(d, &occluder),
    );
    assert!((exact - mean).abs() < 3.5 * error, "{exact} {mean} {error}");
    let beyond = ball([0.1, 0.0, 4.0], 0.1);
    assert_eq!(sphere_over_sphere_light(ORIGIN, &beyond, &light), Ok(1.0));
    let touching = ball([0.1, 0.0, 3.0], 0.1);
    assert!(matches!(sphere_over_sphere_light(ORIGIN, &touching, &light), Err(MeasureError::OutsideDomain { .. })));
}

#[test]
fn bad_input_is_a_typed_error() {
    let nan = f64::NAN;
    let not_finite = |result: Result<f64, MeasureError>| {
        assert!(matches!(result, Err(MeasureError::NotFinite { .. })));
    };
    let degenerate = |result: Result<f64, MeasureError>| {
        assert!(matches!(result, Err(MeasureError::Degenerate { .. })));
    };
    let reversed = AxisRectangle { x: [1.0, -1.0], ..LIGHT };
    let in_light = [0.0, 0.0, 3.0];
    not_finite(half_plane_over_rectangle(nan, 0.0, [1.0; 2]));
    degenerate(half_plane_over_rectangle(0.0, 0.0, [0.0, 1.0]));
    not_finite(rectangle_over_rectangle([nan; 3], &LIGHT, &LIGHT));
    degenerate(rectangle_over_rectangle(ORIGIN, &reversed, &LIGHT));
    degenerate(rectangle_over_rectangle(in_light, &LIGHT, &LIGHT));
    not_finite(disc_over_disc(f64::INFINITY, 1.0, 1.0));
    degenerate(disc_over_disc(1.0, 1.0, 0.0));
    not_finite(sphere_over_rectangle(ORIGIN, &ball([nan; 3], 1.0), &LIGHT));
    degenerate(sphere_over_rectangle(ORIGIN, &ball(ORIGIN, 0.0), &LIGHT));
    degenerate(sphere_over_rectangle(in_light, &ball(ORIGIN, 1.0), &LIGHT));
    degenerate(sphere_over_sphere_light(ORIGIN, &ball(ORIGIN, -1.0), &ball(in_light, 1.0)));
}
