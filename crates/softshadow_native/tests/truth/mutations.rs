//! Spoilt data is seen: any one sign flipped, any one edge dropped, and edges and rays no longer agree.

use softshadow_native::depth_complexity::{Coverage, Receiver};
use softshadow_scene::occluders::{NO_SIDE, Occluders};

use crate::scene::{Random, Setup};
use crate::shapes::{aimed, ball, soup, square};

/// One small body under lights from all around, so that every edge is a silhouette to somebody.
struct Witnesses {
    setups: Vec<Setup>,
    receivers: Vec<(usize, Receiver, u64)>,
}

impl Witnesses {
    fn new() -> Self {
        let mut random = Random(61);
        let from = [[2.0, 2.0, 2.0], [-2.0, -2.0, 2.0], [-2.0, 2.0, -2.0], [2.0, -2.0, -2.0]];
        let mesh = soup(&ball([0.01, 0.02, 0.03], 0.5, 0));
        let setups: Vec<Setup> =
            from.iter().map(|eye| Setup::new(mesh.clone(), aimed(square(2.0), *eye, [0.0; 3]), 64)).collect();
        let receivers = (0..4000)
            .map(|i| {
                let receiver = Receiver { position: random.point([-0.9; 3], [0.9; 3]), ..Receiver::default() };
                (i % 4, receiver, setups[i % 4].hidden_by_rays(&receiver))
            })
            .collect();
        Self { setups, receivers }
    }

    /// Whether anybody sees the difference.
    fn notice(&self, spoil: impl Fn(&mut Occluders)) -> bool {
        let spoilt: Vec<Occluders> = self
            .setups
            .iter()
            .map(|setup| {
                let mut occluders = setup.occluders.clone();
                spoil(&mut occluders);
                occluders
            })
            .collect();
        self.receivers.iter().any(|(at, receiver, rays)| {
            let mut technique = self.setups[*at].technique(Coverage::Exact, false);
            technique.occluders = &spoilt[*at];
            technique.see::<1>(receiver).hidden[0] != *rays
        })
    }
}

#[test]
fn any_one_spoilt_sign_or_edge_is_noticed() {
    let witnesses = Witnesses::new();
    assert!(!witnesses.notice(|_| {}), "what is not spoilt agrees with rays");
    let Occluders { edges, faces, incidences, .. } = witnesses.setups[0].occluders.clone();
    assert_eq!((edges.len(), faces.len(), incidences.len()), (30, 20, 60));
    for edge in 0..edges.len() {
        assert!(witnesses.notice(|o| o.edges[edge].incidence_count = 0), "edge {edge} dropped");
        assert!(
            witnesses.notice(|o| {
                let e = o.edges[edge];
                (o.edges[edge].low, o.edges[edge].high) = (e.high, e.low);
            }),
            "edge {edge} reversed"
        );
    }
    for incidence in 0..incidences.len() {
        assert!(witnesses.notice(|o| o.incidences[incidence] ^= 1), "side of incidence {incidence} flipped");
    }
    for (face, of) in faces.iter().enumerate() {
        let turned = |o: &mut Occluders| o.faces[face].normal = o.faces[face].normal.map(|x| -x);
        assert!(witnesses.notice(turned), "normal of face {face} turned");
        for side in 0..3 {
            assert_ne!(of.sides[side], NO_SIDE);
            assert!(witnesses.notice(|o| o.faces[face].sides[side] ^= 1), "side {side} of face {face} flipped");
        }
    }
}
