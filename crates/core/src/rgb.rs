//! Linear RGB triples.

use std::ops::{Add, AddAssign, Div, Index, IndexMut, Mul, MulAssign, Neg, Sub};

/// Three linear RGB components (Rec. 709 primaries): a radiance in W/(sr m²), a reflectance in `[0, 1]`, or a path
/// throughput, depending on where it stands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Rgb {
    /// Red.
    pub r: f32,
    /// Green.
    pub g: f32,
    /// Blue.
    pub b: f32,
}

impl Rgb {
    /// No light at all.
    pub const BLACK: Rgb = Rgb::splat(0.0);
    /// One in every component.
    pub const WHITE: Rgb = Rgb::splat(1.0);

    /// A triple from its components.
    #[inline]
    pub const fn new(r: f32, g: f32, b: f32) -> Rgb {
        Rgb { r, g, b }
    }

    /// The same value in every component.
    #[inline]
    pub const fn splat(v: f32) -> Rgb {
        Rgb { r: v, g: v, b: v }
    }

    /// The components in order red, green, blue.
    #[inline]
    pub const fn to_array(self) -> [f32; 3] {
        [self.r, self.g, self.b]
    }

    /// Applies `f` to every component.
    #[inline]
    pub fn map(self, f: impl Fn(f32) -> f32) -> Rgb {
        Rgb::new(f(self.r), f(self.g), f(self.b))
    }

    /// Luminance: the Y of CIE XYZ for Rec. 709 primaries [ITU-R BT.709-6, table 3].
    #[inline]
    pub fn luminance(self) -> f32 {
        0.2126 * self.r + 0.7152 * self.g + 0.0722 * self.b
    }

    /// The mean of the components.
    #[inline]
    pub fn mean(self) -> f32 {
        (self.r + self.g + self.b) * (1.0 / 3.0)
    }

    /// The largest component.
    #[inline]
    pub fn max_element(self) -> f32 {
        self.r.max(self.g).max(self.b)
    }

    /// Whether every component is zero.
    #[inline]
    pub fn is_black(self) -> bool {
        self.r == 0.0 && self.g == 0.0 && self.b == 0.0
    }

    /// Whether every component is finite and not negative: what a film accepts.
    #[inline]
    pub fn is_valid(self) -> bool {
        // Without a branch for each: they are all valid nearly always.
        self.to_array().iter().fold(true, |valid, c| valid & (*c >= 0.0) & (*c < f32::INFINITY))
    }
}

impl From<[f32; 3]> for Rgb {
    fn from([r, g, b]: [f32; 3]) -> Rgb {
        Rgb { r, g, b }
    }
}

macro_rules! componentwise {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for Rgb {
            type Output = Rgb;
            #[inline]
            fn $method(self, o: Rgb) -> Rgb {
                Rgb::new(self.r $op o.r, self.g $op o.g, self.b $op o.b)
            }
        }
        impl $trait<f32> for Rgb {
            type Output = Rgb;
            #[inline]
            fn $method(self, s: f32) -> Rgb {
                Rgb::new(self.r $op s, self.g $op s, self.b $op s)
            }
        }
    };
}
componentwise!(Add, add, +);
componentwise!(Sub, sub, -);
componentwise!(Mul, mul, *);
componentwise!(Div, div, /);

impl Mul<Rgb> for f32 {
    type Output = Rgb;
    #[inline]
    fn mul(self, c: Rgb) -> Rgb {
        c * self
    }
}

impl Neg for Rgb {
    type Output = Rgb;
    #[inline]
    fn neg(self) -> Rgb {
        self.map(|c| -c)
    }
}

impl AddAssign for Rgb {
    #[inline]
    fn add_assign(&mut self, o: Rgb) {
        *self = *self + o;
    }
}

impl MulAssign for Rgb {
    #[inline]
    fn mul_assign(&mut self, o: Rgb) {
        *self = *self * o;
    }
}

impl MulAssign<f32> for Rgb {
    #[inline]
    fn mul_assign(&mut self, s: f32) {
        *self = *self * s;
    }
}

impl Index<usize> for Rgb {
    type Output = f32;
    #[inline]
    fn index(&self, i: usize) -> &f32 {
        match i {
            0 => &self.r,
            1 => &self.g,
            2 => &self.b,
            _ => panic!("Rgb index {i} out of range"),
        }
    }
}

impl IndexMut<usize> for Rgb {
    #[inline]
    fn index_mut(&mut self, i: usize) -> &mut f32 {
        match i {
            0 => &mut self.r,
            1 => &mut self.g,
            2 => &mut self.b,
            _ => panic!("Rgb index {i} out of range"),
        }
    }
}

impl std::iter::Sum for Rgb {
    fn sum<I: Iterator<Item = Rgb>>(iter: I) -> Rgb {
        iter.fold(Rgb::BLACK, Add::add)
    }
}
