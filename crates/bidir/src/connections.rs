//! Connections between two walks that are still to be tested for what lies between, and the choice of those that are.

use etendue_core::{ray::Ray, rgb::Rgb, technique::Part};

/// A connection of a light's vertex and a camera's that light may pass.
#[derive(Clone, Copy, Debug)]
pub struct Connection {
    /// Vertices made from the light.
    pub s: u32,
    /// Vertices made from the camera.
    pub t: u32,
    /// The part of the light that the path belongs to.
    pub part: Part,
    /// What it contributes if nothing lies between, unweighted.
    pub value: Rgb,
    /// Its share among all strategies.
    pub weight: f32,
    /// From one end to the other.
    pub ray: Ray,
}

impl Connection {
    fn importance(&self) -> f32 {
        self.value.max_element() * self.weight
    }
}

/// Chooses about `tests` of the connections, each with a probability in proportion to its weighted contribution, which is
/// told with it; `u` is a number in `[0, 1)`. Russian roulette with one number for all [Veach 1997, sec. 10.4]: the
/// probabilities add up from `u` on, and where their sum passes a whole number a connection is chosen, so that how many
/// are chosen hardly varies. Those of more than their share are always chosen.
pub fn choose(connections: &[Connection], tests: f32, u: f32) -> impl Iterator<Item = (&Connection, f32)> {
    let total: f32 = connections.iter().map(Connection::importance).sum();
    let scale = tests / total;
    let mut sum = f64::from(u);
    connections.iter().filter_map(move |connection| {
        // Where the total is 0 or no number, neither is this, and the minimum is 1.
        let probability = (connection.importance() * scale).min(1.0);
        sum += f64::from(probability);
        let chosen = sum >= 1.0;
        sum -= f64::from(u8::from(chosen));
        chosen.then_some((connection, probability))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn each_is_chosen_with_its_probability() {
        let weights = [0.5, 0.0, 3.0, 0.25, 0.25, 1.0];
        let connection = |weight: f32| Connection {
            s: 2,
            t: 2,
            part: Part::Indirect,
            value: Rgb::new(0.5, 1.0, 0.0),
            weight,
            ray: Ray::new(Vec3::ZERO, Vec3::X),
        };
        let connections = weights.map(connection);
        let steps = 1 << 14;
        let mut counts = [0; 6];
        for step in 0..steps {
            let chosen: Vec<_> = choose(&connections, 2.0, (step as f32 + 0.5) / steps as f32).collect();
            assert!((1..=3).contains(&chosen.len()), "{}", chosen.len());
            for (c, probability) in chosen {
                let i = connections.iter().position(|other| std::ptr::eq(other, c)).unwrap();
                assert_eq!(probability, (0.4 * weights[i]).min(1.0));
                counts[i] += 1;
            }
        }
        for (count, weight) in counts.iter().zip(weights) {
            let share = *count as f32 / steps as f32;
            assert!((share - (0.4 * weight).min(1.0)).abs() < 2.0 / steps as f32, "{counts:?}");
        }
        // Nothing to tell them apart by: none is lost.
        assert_eq!(choose(&[0.0; 3].map(connection), 2.0, 0.3).count(), 3);
        assert_eq!(choose(&[1.0, f32::NAN].map(connection), 1.0, 0.3).count(), 2);
    }
}
