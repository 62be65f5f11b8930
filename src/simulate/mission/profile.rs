//! A quantity against depth or distance, as a pilot writes it down: a few points, straight lines between them.

use crate::Number;

/// Points joined by straight lines; beyond the ends the value stays that of the end.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    xs: Vec<f64>,
    ys: Vec<f64>,
}

impl Profile {
    /// The same value everywhere.
    pub fn constant(value: f64) -> Self {
        Profile { xs: vec![0.0], ys: vec![value] }
    }

    /// Through these points. `None` unless there are as many values as places, at least one, and the places increase.
    pub fn new(xs: Vec<f64>, ys: Vec<f64>) -> Option<Self> {
        let increase = xs.windows(2).all(|pair| pair[0] < pair[1]);
        (!xs.is_empty() && xs.len() == ys.len() && increase).then_some(Profile { xs, ys })
    }

    /// The value at a place.
    pub fn at<T: Number>(&self, x: T) -> T {
        let after = self.xs.partition_point(|knot| *knot <= x.value());
        if after == 0 {
            return T::constant(self.ys[0]);
        }
        if after == self.xs.len() {
            return T::constant(self.ys[after - 1]);
        }
        let (x0, x1) = (self.xs[after - 1], self.xs[after]);
        let (y0, y1) = (self.ys[after - 1], self.ys[after]);
        (x - x0) * (y1 - y0) / (x1 - x0) + y0
    }

    /// How fast the value changes with the place; at a point that of the line behind it.
    pub fn slope(&self, x: f64) -> f64 {
        let after = self.xs.partition_point(|knot| *knot <= x);
        if after == 0 || after == self.xs.len() {
            return 0.0;
        }
        (self.ys[after] - self.ys[after - 1]) / (self.xs[after] - self.xs[after - 1])
    }

    /// Places and values of the points.
    pub fn points(&self) -> impl Iterator<Item = (f64, f64)> {
        self.xs.iter().copied().zip(self.ys.iter().copied())
    }

    /// The largest value anywhere.
    pub fn largest(&self) -> f64 {
        self.ys.iter().copied().fold(f64::NEG_INFINITY, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_between_the_points_and_level_beyond() {
        let profile = Profile::new(vec![0.0, 10.0, 30.0], vec![1.0, 2.0, 0.0]).unwrap();
        let found = [-5.0, 0.0, 5.0, 10.0, 20.0, 30.0, 99.0].map(|x| profile.at(x));
        assert_eq!(found, [1.0, 1.0, 1.5, 2.0, 1.0, 0.0, 0.0]);
        assert_eq!([-5.0, 0.0, 5.0, 10.0, 20.0, 30.0].map(|x| profile.slope(x)), [0.0, 0.1, 0.1, -0.1, -0.1, 0.0]);
        assert!(Profile::new(vec![0.0, 0.0], vec![1.0, 2.0]).is_none());
        assert!(Profile::new(vec![0.0], vec![1.0, 2.0]).is_none());
    }
}
