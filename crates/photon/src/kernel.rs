//! How photons count by their distance.

/// A filter over the disk in which photons are gathered; its mean over the disk is 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernel {
    /// All alike.
    Disk,
    /// Falls linearly to nothing at the border. [Jensen 1996, eq. 10, with k = 1]
    Cone,
    /// Falls like a Gaussian to nothing at the border. [Pavicic 1990; Jensen 2001, eq. 7.9]
    Gaussian,
}

/// Exponent of the Gaussian filter. [Jensen 2001, eq. 7.10]
const BETA: f32 = 1.953;

impl Kernel {
    /// All of them, in the order of the techniques' knob.
    pub const ALL: [Kernel; 3] = [Kernel::Disk, Kernel::Cone, Kernel::Gaussian];

    /// Its value at `t`, the squared distance over the squared radius, in `[0, 1]`.
    #[inline]
    pub fn weight(self, t: f32) -> f32 {
        match self {
            Kernel::Disk => 1.0,
            // The mean of 1 - r over the unit disk is 1/3.
            Kernel::Cone => 3.0 * (1.0 - t.sqrt()),
            Kernel::Gaussian => {
                let range = 1.0 - (-BETA).exp();
                let falling = |t: f32| 1.0 - (1.0 - (-0.5 * BETA * t).exp()) / range;
                // By integration; t is uniform over the disk. The value at the border is taken off, so that it ends at 0.
                let mean = 1.0 - (1.0 - 2.0 / BETA * (1.0 - (-0.5 * BETA).exp())) / range;
                let border = falling(1.0);
                (falling(t) - border) / (mean - border)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_over_the_disk_is_1() {
        for kernel in Kernel::ALL {
            let n = 100_000;
            let sum: f64 = (0..n).map(|i| f64::from(kernel.weight((i as f32 + 0.5) / n as f32))).sum();
            assert!((sum / f64::from(n) - 1.0).abs() < 1e-4, "{kernel:?}: {sum}");
            assert!((0..=n).all(|i| kernel.weight(i as f32 / n as f32) >= 0.0));
        }
        assert_eq!(Kernel::Cone.weight(1.0), 0.0);
        assert!(Kernel::Gaussian.weight(1.0).abs() < 1e-6);
    }
}
