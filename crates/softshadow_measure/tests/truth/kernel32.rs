//! Float32 shadow-ray kernels, right and wrong ones, and the count of what they get wrong.

use softshadow_measure::{Receiver, SampleVerdict, Target, Triangle};

type V3 = [f32; 3];

/// What may be wrong with a kernel.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Kernel {
    Correct,
    /// The products of every determinant are summed in another order, with fused multiply-adds.
    Fused,
    /// Plane and far end from the vectors to the corners: `T = a·(b×c)`, `D = E01 + E12 − E02`. The same numbers without
    /// rounding; with it, noise for a small triangle far away.
    PlaneFromCorners,
    /// Edges from the vectors to both corners, `d·(a×b)`: noise, likewise.
    EdgesFromCorners,
    WrongSign,
    BlindToItsEnd,
    /// The occluders lie one part in a thousand off.
    Shifted,
}

fn sub(a: V3, b: V3) -> V3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn det(x: V3, y: V3, z: V3, kernel: Kernel) -> f32 {
    if kernel == Kernel::Fused {
        let minor = |i: usize, j: usize| y[i].mul_add(z[j], -(y[j] * z[i]));
        return x[2].mul_add(minor(0, 1), x[1].mul_add(minor(2, 0), x[0] * minor(1, 2)));
    }
    x[0] * (y[1] * z[2] - y[2] * z[1]) + x[1] * (y[2] * z[0] - y[0] * z[2]) + x[2] * (y[0] * z[1] - y[1] * z[0])
}

fn blocked(p: V3, target: Target, mut face: [V3; 3], kernel: Kernel) -> bool {
    if kernel == Kernel::Shifted {
        face.iter_mut().for_each(|corner| corner[0] += 1e-3);
    }
    let [a, b, c] = face.map(|corner| sub(corner, p));
    let (d, at_infinity) = relative(p, target);
    let (e1, e2, e3) = (sub(face[1], face[0]), sub(face[2], face[0]), sub(face[2], face[1]));
    let (e01, e12, e02) = if kernel == Kernel::EdgesFromCorners {
        (det(d, a, b, kernel), det(d, b, c, kernel), det(d, a, c, kernel))
    } else {
        (det(d, a, e1, kernel), det(d, b, e3, kernel), det(d, a, e2, kernel))
    };
    let e02 = e02 * if kernel == Kernel::WrongSign { -1.0 } else { 1.0 };
    let (volume, depth) = if kernel == Kernel::PlaneFromCorners {
        (det(a, b, c, kernel), e01 + e12 - e02)
    } else {
        (det(a, e1, e2, kernel), det(d, e1, e2, kernel))
    };
    let edges = [e01, e12, -e02];
    (edges.iter().all(|e| *e >= 0.0) || edges.iter().all(|e| *e <= 0.0))
        && depth != 0.0
        && volume != 0.0
        && (volume > 0.0) == (depth > 0.0)
        && (at_infinity || kernel == Kernel::BlindToItsEnd || volume.abs() < depth.abs())
}

fn relative(p: V3, target: Target) -> (V3, bool) {
    match target {
        Target::Point(s) => (sub(s.map(|x| x as f32), p), false),
        Target::Direction(d) => (d.map(|x| x as f32), true),
    }
}

pub(crate) fn visible(receiver: &Receiver, target: Target, mesh: &[Triangle], kernel: Kernel) -> bool {
    let single = |point: [f64; 3]| point.map(|x| x as f32);
    let p = single(receiver.origin);
    let above = receiver.normal.is_none_or(|normal| {
        let (n, (d, _)) = (single(normal), relative(p, target));
        n[0] * d[0] + n[1] * d[1] + n[2] * d[2] > 0.0
    });
    above
        && !mesh.iter().enumerate().any(|(index, face)| {
            receiver.excluded_triangle != Some(index) && blocked(p, target, face.map(single), kernel)
        })
}

#[derive(Default)]
pub(crate) struct Comparison {
    pub(crate) samples: usize,
    pub(crate) blocked: usize,
    pub(crate) grazing: usize,
    pub(crate) excused: usize,
    pub(crate) wrong: usize,
}

impl Comparison {
    pub(crate) fn add(&mut self, verdict: SampleVerdict, visible: bool) {
        self.samples += 1;
        self.blocked += usize::from(!verdict.visible);
        self.grazing += usize::from(verdict.grazing);
        let differs = verdict.visible != visible;
        self.excused += usize::from(differs && verdict.grazing);
        self.wrong += usize::from(differs && !verdict.grazing);
    }
}

pub(crate) fn single_precision(point: [f64; 3]) -> [f64; 3] {
    point.map(|x| f64::from(x as f32))
}
