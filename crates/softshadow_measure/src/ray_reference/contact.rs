//! How one blocker meets one ray: as float64 sees it, and as any evaluation within the rounding bounds may.

/// How one blocker meets one ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Contact {
    /// The float64 answer.
    pub(super) hit: bool,
    /// Some float32 evaluation within the bounds finds a hit.
    pub(super) possible: bool,
    /// Every float32 evaluation within the bounds finds a hit.
    pub(super) certain: bool,
}

impl Contact {
    pub(super) const NONE: Self = Self { hit: false, possible: false, certain: false };

    pub(super) fn or(self, other: Self) -> Self {
        Self {
            hit: self.hit || other.hit,
            possible: self.possible || other.possible,
            certain: self.certain || other.certain,
        }
    }

    /// Whether float32 rounding may turn the answer over.
    pub(super) fn is_grazing(self) -> bool {
        self.possible && !self.certain
    }
}

/// The determinants that decide, each a value with its bound.
#[derive(Clone, Copy)]
pub(super) struct Determinants {
    /// E01, E12 and −E02.
    pub(super) edges: [[f64; 2]; 3],
    /// D.
    pub(super) depth: [f64; 2],
    /// T.
    pub(super) volume: [f64; 2],
    /// T − D: with both positive, the target lies beyond the triangle when this is negative. `None` for a target at
    /// infinity.
    pub(super) excess: Option<[f64; 2]>,
}

impl Determinants {
    pub(super) fn contact(&self) -> Contact {
        let mirrored = |x: [f64; 2]| [-x[0], x[1]];
        let back = Self {
            edges: self.edges.map(mirrored),
            depth: mirrored(self.depth),
            volume: mirrored(self.volume),
            excess: self.excess.map(mirrored),
        };
        self.positive_contact().or(back.positive_contact())
    }

    /// The contact under the assumption that all determinants are positive.
    fn positive_contact(&self) -> Contact {
        let holds = |slack: f64| {
            self.edges.iter().all(|[e, bound]| e + slack * bound >= 0.0)
                && self.depth[0] + slack * self.depth[1] > 0.0
                && self.volume[0] + slack * self.volume[1] > 0.0
                && self.excess.is_none_or(|[excess, bound]| excess < slack * bound)
        };
        Contact { hit: holds(0.0), possible: holds(1.0), certain: holds(-1.0) }
    }
}
