//! Weights that join all strategies of bidirectional path tracing, summed up while walking.
//!
//! A path `x_0 x_1 ... x_k` leads from a light to the camera. Strategy `s` makes its first `s` vertices by a walk from the light
//! and the other `t = k + 1 - s` by one from the camera. Its density and that of strategy `s + 1` differ in one factor: `x_s` is
//! found by the camera's walk in one, by the light's in the other. So their quotients are products along the path
//! [Veach 1997, sec. 10.2.1], and the sum of all on one side of a connection can be carried by the walk itself in a few numbers
//! a vertex, [`Prefix`], as soon as each walk also knows the density of its steps taken backwards [van Antwerpen 2011;
//! Georgiev 2012, "Implementing Vertex Connection and Merging"]. Nothing is ever summed over stored vertices.
//!
//! These are plain numbers, for anybody's renderer: densities come in, weights come out. Where a vertex scatters by a delta
//! lobe, no strategy can connect it, and its densities forwards and backwards both have the same delta factor, which is left
//! out: what counts is their quotient.
//!
//! ```
//! use etendue_bidir::weights::{Heuristic, LightEnd, Prefix};
//! // A light at x_0, a surface at x_1, the camera at x_2: it is lit by next-event estimation (s = 1), found by the camera's
//! // walk that goes on to the light (s = 0), or seen by a walk from the light (s = 2).
//! let end = LightEnd { direct: 0.5, emitted: 0.25, onward: 0.1, hit: 0.2 };
//! let (camera_to_x1, x1_to_light) = (0.3, 0.4);
//! let h = Heuristic::Balance;
//! let camera = Prefix::from_camera(h, camera_to_x1);
//! let left = camera.leave(h, 0.7, false).with_splats(h, 1.0);
//! let hit = h.hit(&end, x1_to_light, false, left);
//! let next_event = h.next_event(&end, x1_to_light, left);
//! let light = Prefix::from_light(h, &end);
//! let seen = h.joined(camera_to_x1 * light.leave(h, x1_to_light, false).others);
//! assert!((hit + next_event + seen - 1.0).abs() < 1e-12);
//! // The densities of the three strategies themselves:
//! let densities = [camera_to_x1 * x1_to_light * end.hit, camera_to_x1 * end.direct, end.emitted * end.onward];
//! assert!((hit - densities[0] / densities.iter().sum::<f64>()).abs() < 1e-12);
//! ```

/// How the strategies that can make a path share it: weights from the densities `p_i` with which they do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Heuristic {
    /// `p_s / sum p_i` [Veach 1997, eq. 9.8].
    Balance,
    /// `p_s² / sum p_i²` [Veach 1997, eq. 9.13].
    #[default]
    Power,
    /// All to the largest density [Veach 1997, sec. 9.2.2].
    Maximum,
}

/// By how much [`Heuristic::Maximum`] favours each vertex that is made from the camera. There are scenes in which whole families
/// of strategies have one density (inside a diffuse sphere all have): rounding must not decide between them differently
/// from strategy to strategy, or their weights would not sum to 1.
const FAVOUR: f64 = 1.0 + 1.0 / 1024.0;

impl Heuristic {
    /// All of them.
    pub const ALL: [Heuristic; 3] = [Heuristic::Balance, Heuristic::Power, Heuristic::Maximum];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Heuristic::Balance => "balance",
            Heuristic::Power => "power",
            Heuristic::Maximum => "maximum",
        }
    }

    /// What a quotient of densities adds to the sum of all strategies.
    #[inline]
    pub fn term(self, quotient: f64) -> f64 {
        match self {
            Heuristic::Balance | Heuristic::Maximum => quotient,
            Heuristic::Power => quotient * quotient,
        }
    }

    /// The sum, of which the largest term is all that [`Heuristic::Maximum`] asks for.
    #[inline]
    fn sum(self, a: f64, b: f64) -> f64 {
        match self {
            Heuristic::Balance | Heuristic::Power => a + b,
            Heuristic::Maximum => a.max(b),
        }
    }

    /// The factor on a quotient in which a vertex goes from the light's walk to the camera's.
    #[inline]
    fn favour(self) -> f64 {
        match self {
            Heuristic::Balance | Heuristic::Power => 1.0,
            Heuristic::Maximum => FAVOUR,
        }
    }

    /// The weight of a strategy, given the sum of the terms of all others relative to its own density.
    #[inline]
    pub fn joined(self, others: f64) -> f64 {
        match self {
            Heuristic::Balance | Heuristic::Power => 1.0 / (1.0 + others),
            Heuristic::Maximum => f64::from(others < 1.0),
        }
    }

    /// The weight of a connection between a vertex `y` of a walk from a light and a vertex `z` of one from the camera
    /// (`s >= 2`, `t >= 2`).
    ///
    /// `y` is what is [left](Prefix::leave) of `y` towards `z`, and `pdf_a_y` the density per square metre with which the camera's walk
    /// would go on from `z` to `y`; `z` and `pdf_a_z` the other way round.
    #[inline]
    pub fn connected(self, y: f64, pdf_a_y: f64, z: f64, pdf_a_z: f64) -> f64 {
        self.joined(self.sum(self.term(pdf_a_y) * y, self.term(pdf_a_z) * z))
    }

    /// The weight of a vertex `x_1` of a walk from the camera that is lit by next-event estimation (`s = 1`).
    ///
    /// `pdf_w` is the density per steradian with which the walk would go on to the light, `x_1` what is
    /// [left](Prefix::leave) of it towards the light.
    #[inline]
    pub fn next_event(self, end: &LightEnd, pdf_w: f64, x_1: f64) -> f64 {
        let hit = self.term(self.favour() * (pdf_w * end.hit / end.direct));
        self.joined(self.sum(hit, self.term(end.emitted * end.onward / end.direct) * x_1))
    }

    /// The weight of a walk from the camera that runs into a light (`s = 0`).
    ///
    /// It got there from `x_1` by a direction of density `pdf_w` per steradian; `delta` says whether by a delta lobe, and `x_1`
    /// is what is [left](Prefix::leave) of it towards the light.
    #[inline]
    pub fn hit(self, end: &LightEnd, pdf_w: f64, delta: bool, x_1: f64) -> f64 {
        let found = self.favour() * (pdf_w * end.hit);
        let direct = if delta { 0.0 } else { self.term(end.direct / found) };
        self.joined(self.sum(direct, self.term(end.emitted * end.onward / found) * x_1))
    }
}

/// Densities at the light's end of a path, where `x_0` is on the light and `x_1` the first surface. Those of `x_0` have
/// one measure: square metres on a light with a surface, steradians for light from infinity, none for a light that is chosen
/// as a whole (a point light, a directional one).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightEnd {
    /// Density of `x_0` by next-event estimation at `x_1`.
    pub direct: f64,
    /// Density of `x_0` where a walk starts.
    pub emitted: f64,
    /// Density of `x_1` per square metre as the first vertex of a walk from `x_0`.
    pub onward: f64,
    /// What turns a density per steradian of directions from `x_1` into one of `x_0`; 0 where the light cannot be hit.
    pub hit: f64,
}

/// What a vertex of a walk knows of the strategies that would have ended this walk earlier.
///
/// [`Prefix::from_light`] or [`Prefix::from_camera`] makes that of the first surface, [`Prefix::next`] that of each further one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prefix {
    /// Density of the vertex per square metre.
    pdf_a: f64,
    /// The side's factor on quotients.
    favour: f64,
    /// Term of the strategy that connects the vertex before to this one: 1 where that can be.
    connected: Left,
    /// Terms of all that end earlier, for a density of 1 per steradian of the step back from here.
    earlier: Left,
}

/// What the strategies that would have ended a walk before a vertex add to a weight: the splat (`t = 1`) by itself, as only who
/// knows the whole path can say how many particles there were for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Left {
    /// Terms of all but the splat.
    pub others: f64,
    /// Term of the splat, with one particle for each path from the camera; 0 on walks from lights.
    pub splat: f64,
}

impl Left {
    const NOTHING: Left = Left { others: 0.0, splat: 0.0 };

    /// All terms, with `splats` particles for each path from the camera.
    #[inline]
    pub fn with_splats(self, heuristic: Heuristic, splats: f64) -> f64 {
        heuristic.sum(self.others, heuristic.term(splats) * self.splat)
    }

    #[inline]
    fn scaled(self, factor: f64) -> Left {
        Left { others: self.others * factor, splat: self.splat * factor }
    }
}

impl Prefix {
    /// The first surface that a walk from a light finds.
    #[inline]
    pub fn from_light(heuristic: Heuristic, end: &LightEnd) -> Prefix {
        let favour = heuristic.favour();
        Prefix {
            pdf_a: end.onward,
            favour,
            // The light itself is connected by next-event estimation, which has its own density.
            connected: Left { others: heuristic.term(end.direct / end.emitted), splat: 0.0 },
            earlier: Left { others: heuristic.term(favour * (end.hit / end.emitted)), splat: 0.0 },
        }
    }

    /// The first surface that a walk from the camera finds, with a density `pdf_a` per square metre. No walk from a light
    /// runs into a camera.
    #[inline]
    pub fn from_camera(heuristic: Heuristic, pdf_a: f64) -> Prefix {
        Prefix {
            pdf_a,
            favour: 1.0 / heuristic.favour(),
            connected: Left { others: 0.0, splat: 1.0 },
            earlier: Left::NOTHING,
        }
    }

    /// The terms of all strategies in which this walk ends before this vertex, relative to ending it here, for a
    /// density of 1 per square metre with which the walk from the other side finds this vertex.
    ///
    /// The path leaves the vertex in some direction. `reverse` is the density per steradian with which the other walk,
    /// coming from there, would step back to the vertex before this one; `delta` says that this is by a delta lobe.
    #[inline]
    pub fn leave(&self, heuristic: Heuristic, reverse: f64, delta: bool) -> Left {
        let connected = if delta { Left::NOTHING } else { self.connected };
        let earlier = self.earlier.scaled(heuristic.term(reverse));
        let all = Left {
            others: heuristic.sum(connected.others, earlier.others),
            splat: heuristic.sum(connected.splat, earlier.splat),
        };
        all.scaled(heuristic.term(self.favour / self.pdf_a))
    }

    /// The next vertex of the walk: `left` is [`Prefix::leave`] of this one in the direction of the step, by a delta lobe or
    /// not.
    ///
    /// `pdf_a` is the next vertex's density per square metre, and `back` what turns a density per steradian of the step back
    /// from there into one per square metre at this vertex: the cosine here over the squared distance.
    #[inline]
    pub fn next(&self, heuristic: Heuristic, left: Left, delta: bool, back: f64, pdf_a: f64) -> Prefix {
        let connected = Left { others: f64::from(!delta), splat: 0.0 };
        Prefix { pdf_a, favour: self.favour, connected, earlier: left.scaled(heuristic.term(back)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The densities of a path of `n` surfaces, `x_1` to `x_n`.
    #[derive(Clone, Debug)]
    struct Chain {
        end: LightEnd,
        /// Density per steradian of the light from `x_1`.
        to_light: f64,
        surfaces: Vec<Surface>,
        /// Particles for each path from the camera.
        splats: f64,
    }

    /// A surface and the way to the next one.
    #[derive(Clone, Copy, Debug)]
    struct Surface {
        delta: bool,
        /// Densities per steradian of the next surface from here, and of this one from there.
        onward: f64,
        back: f64,
        /// What turns them into ones per square metre. The last surface's are those of the camera.
        there: f64,
        here: f64,
    }

    impl Chain {
        /// The density of each strategy, multiplied together.
        fn densities(&self) -> Vec<f64> {
            let n = self.surfaces.len();
            (0..=n + 1)
                .map(|s| {
                    let joined = match s {
                        0 => true,
                        1 => !self.surfaces[0].delta,
                        s => !self.surfaces[s - 2].delta && (s > n || !self.surfaces[s - 1].delta),
                    };
                    let first = [self.to_light * self.end.hit, self.end.direct, self.end.emitted][s.min(2)];
                    let light = (1..n).filter(|i| i + 1 < s).map(|i| {
                        let before = &self.surfaces[i - 1];
                        before.onward * before.there
                    });
                    let camera = (0..n).filter(|i| i + 1 >= s).map(|i| self.surfaces[i].back * self.surfaces[i].here);
                    let onward = if s > 1 { self.end.onward } else { 1.0 };
                    let number = if s == n + 1 { self.splats } else { 1.0 };
                    f64::from(joined) * first * onward * light.product::<f64>() * camera.product::<f64>() * number
                })
                .collect()
        }

        /// The weight of each strategy, as walks sum it up.
        fn recursive(&self, h: Heuristic) -> Vec<f64> {
            let n = self.surfaces.len();
            // From surface i back: to the surface before, or to the light.
            let back = |i: usize| if i == 0 { self.to_light } else { self.surfaces[i - 1].back };
            // From surface i onward by the light's walk; that the camera is connected has no density of its own.
            let onward = |i: usize| self.surfaces[i].onward;
            let mut light = vec![Prefix::from_light(h, &self.end)];
            for i in 1..n {
                let s = &self.surfaces[i - 1];
                let left = light[i - 1].leave(h, back(i - 1), s.delta);
                light.push(light[i - 1].next(h, left, s.delta, s.here, s.onward * s.there));
            }
            let last = &self.surfaces[n - 1];
            let mut camera = vec![Prefix::from_camera(h, last.back * last.here)];
            for i in (0..n - 1).rev() {
                let (s, before) = (&self.surfaces[i], &self.surfaces[i + 1]);
                let left = camera[0].leave(h, onward(i + 1), before.delta);
                camera.insert(0, camera[0].next(h, left, before.delta, s.there, s.back * s.here));
            }
            (0..=n + 1)
                .map(|s| match s {
                    0 => {
                        let first = &self.surfaces[0];
                        let left = camera[0].leave(h, onward(0), first.delta).with_splats(h, self.splats);
                        h.hit(&self.end, self.to_light, first.delta, left)
                    }
                    1 if !self.surfaces[0].delta => {
                        let left = camera[0].leave(h, onward(0), false).with_splats(h, self.splats);
                        h.next_event(&self.end, self.to_light, left)
                    }
                    s if s == n + 1 && !last.delta => {
                        let found = last.back * last.here / self.splats;
                        h.joined(h.term(found) * light[n - 1].leave(h, back(n - 1), false).others)
                    }
                    s if (2..=n).contains(&s) && !self.surfaces[s - 2].delta && !self.surfaces[s - 1].delta => {
                        let (y, z) = (&self.surfaces[s - 2], s - 1);
                        let y_left = light[s - 2].leave(h, back(s - 2), false).others;
                        let z_left = camera[z].leave(h, onward(z), false).with_splats(h, self.splats);
                        h.connected(y_left, y.back * y.here, z_left, y.onward * y.there)
                    }
                    _ => 0.0,
                })
                .collect()
        }
    }

    fn density() -> impl Strategy<Value = f64> {
        (-12.0..12.0f64).prop_map(|e| 10f64.powf(e))
    }

    fn chain() -> impl Strategy<Value = Chain> {
        let surface = (any::<bool>(), density(), density(), density(), density())
            .prop_map(|(delta, onward, back, there, here)| Surface { delta, onward, back, there, here });
        let end = (density(), density(), density(), prop_oneof![density(), Just(0.0)])
            .prop_map(|(direct, emitted, onward, hit)| LightEnd { direct, emitted, onward, hit });
        (end, density(), prop::collection::vec(surface, 1..9), density())
            .prop_map(|(end, to_light, surfaces, splats)| Chain { end, to_light, surfaces, splats })
    }

    proptest! {
        #[test]
        fn recursive_weights_are_those_of_all_densities(chain in chain()) {
            let p = chain.densities();
            let largest = p.iter().copied().fold(0.0, f64::max);
            prop_assume!(largest > 0.0);
            let p: Vec<f64> = p.iter().map(|p| p / largest).collect();
            for h in [Heuristic::Balance, Heuristic::Power] {
                let total: f64 = p.iter().map(|p| h.term(*p)).sum();
                let weights = chain.recursive(h);
                for (s, (weight, p)) in weights.iter().zip(&p).enumerate() {
                    // No walk ever makes a path by a strategy that cannot make it.
                    if *p > 0.0 {
                        prop_assert!((weight - h.term(*p) / total).abs() < 1e-9, "{h:?} {s}: {weights:?} {p:?}");
                    }
                }
            }
            let weights = chain.recursive(Heuristic::Maximum);
            let chosen: Vec<f64> = weights.iter().zip(&p).filter(|(w, p)| **w == 1.0 && **p > 0.0).map(|(_, p)| *p).collect();
            // Ties within a thousandth a vertex are broken one way.
            prop_assert!(chosen.len() == 1 && chosen[0] > 0.98, "{weights:?} {p:?}");
        }
    }

    #[test]
    fn ties_are_broken_one_way() {
        // All strategies have the same density, up to rounding.
        let third = 1.0 / 3.0;
        let surface = Surface { delta: false, onward: third, back: third, there: 3.0, here: 3.0 };
        let end = LightEnd { direct: third, emitted: third, onward: 1.0, hit: 1.0 };
        let chain = Chain { end, to_light: third, surfaces: vec![surface; 6], splats: 1.0 };
        let weights = chain.recursive(Heuristic::Maximum);
        assert_eq!(weights, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        for h in [Heuristic::Balance, Heuristic::Power] {
            assert!(chain.recursive(h).iter().all(|w| (w - 0.125).abs() < 1e-12));
        }
    }
}
