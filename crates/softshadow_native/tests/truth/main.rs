//! Silhouette edges against rays: the claim on which everything fast here stands.

mod areas;
mod hard_cases;
mod lights;
mod mutations;
mod real_meshes;
mod scene;
mod semi_opaque;
mod shapes;
mod tables;
