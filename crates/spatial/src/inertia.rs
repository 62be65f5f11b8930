//! The symmetric inertia of all six degrees of freedom: masses anywhere, rigid bodies, added mass with its couplings.

use glidepolar_number::Number;

use super::vector::{Vector, cross};

/// `(P, Pi) = M (v, Om)` about the centre of buoyancy, rows and columns in the order 1, 2, 3, roll, pitch, yaw.
#[derive(Debug, Clone, Copy)]
pub struct Inertia<T>(pub [[T; 6]; 6]);

impl<T: Number> Inertia<T> {
    /// Of nothing.
    pub fn zero() -> Self {
        Inertia([[T::constant(0.0); 6]; 6])
    }

    /// Adds a value at a place and its mirror image.
    pub fn add(&mut self, row: usize, column: usize, value: T) {
        self.0[row][column] += value;
        if row != column {
            self.0[column][row] += value;
        }
    }

    /// Adds a point mass at a place in the hull.
    pub fn add_mass(&mut self, mass: T, [x, y, z]: Vector<T>) {
        for axis in 0..3 {
            self.add(axis, axis, mass);
        }
        // P = m (v + Om x r): the momentum along axis 1 per pitch rate is m z, and so on.
        self.add(0, 4, mass * z);
        self.add(0, 5, -mass * y);
        self.add(1, 3, -mass * z);
        self.add(1, 5, mass * x);
        self.add(2, 3, mass * y);
        self.add(2, 4, -mass * x);
        self.add(3, 3, mass * (y * y + z * z));
        self.add(4, 4, mass * (x * x + z * z));
        self.add(5, 5, mass * (x * x + y * y));
        self.add(3, 4, -mass * x * y);
        self.add(3, 5, -mass * x * z);
        self.add(4, 5, -mass * y * z);
    }

    /// Momentum and angular momentum of a motion.
    pub fn times(&self, v: Vector<T>, rates: Vector<T>) -> (Vector<T>, Vector<T>) {
        let motion = [v[0], v[1], v[2], rates[0], rates[1], rates[2]];
        let row = |i: usize| {
            let mut sum = T::constant(0.0);
            for (m, x) in self.0[i].iter().zip(motion) {
                sum += *m * x;
            }
            sum
        };
        (std::array::from_fn(row), std::array::from_fn(|i| row(i + 3)))
    }

    /// The accelerations that a force and a moment give, by `L D L'`; every true inertia is positive definite.
    pub fn solve(&self, force: Vector<T>, moment: Vector<T>) -> (Vector<T>, Vector<T>) {
        let mut upper = self.0;
        let mut x = [force[0], force[1], force[2], moment[0], moment[1], moment[2]];
        for column in 0..6 {
            let pivot = upper[column];
            for row in column + 1..6 {
                let factor = pivot[row] / pivot[column];
                for (value, above) in upper[row].iter_mut().zip(pivot).skip(row) {
                    *value -= factor * above;
                }
                let above = x[column];
                x[row] -= factor * above;
            }
        }
        for row in (0..6).rev() {
            let mut sum = x[row];
            for k in row + 1..6 {
                sum -= upper[row][k] * x[k];
            }
            x[row] = sum / upper[row][row];
        }
        ([x[0], x[1], x[2]], [x[3], x[4], x[5]])
    }
}

/// The mass that moves: its place, its speed in the hull, its turning about axis 1 and its own inertia.
#[derive(Debug, Clone, Copy)]
pub struct Mover<T> {
    pub mass: T,
    pub place: Vector<T>,
    pub speed: Vector<T>,
    /// Rate of turning relative to the hull.
    pub turning: Vector<T>,
    pub own: [[T; 3]; 3],
}

impl<T: Number> Mover<T> {
    fn own_times(&self, a: Vector<T>) -> Vector<T> {
        self.own.map(|row| row[0] * a[0] + row[1] * a[1] + row[2] * a[2])
    }

    /// Adds it, where it is, to the inertia of the hull.
    pub fn join(&self, inertia: &mut Inertia<T>) {
        inertia.add_mass(self.mass, self.place);
        for i in 0..3 {
            for j in i..3 {
                inertia.add(i + 3, j + 3, self.own[i][j]);
            }
        }
    }

    /// Momentum and angular momentum that it has by moving relative to the hull.
    pub fn relative(&self) -> (Vector<T>, Vector<T>) {
        let momentum = self.speed.map(|s| s * self.mass);
        let (turning, own) = (cross(self.place, momentum), self.own_times(self.turning));
        (momentum, [turning[0] + own[0], turning[1] + own[1], turning[2] + own[2]])
    }

    /// Rate of change of momentum and angular momentum in body axes at constant motion of the hull, for an acceleration
    /// of the mass relative to the hull and of its turning.
    pub fn rate(
        &self,
        v: Vector<T>,
        rates: Vector<T>,
        acceleration: Vector<T>,
        turning_acceleration: Vector<T>,
    ) -> (Vector<T>, Vector<T>) {
        let momentum_rate: Vector<T> =
            std::array::from_fn(|i| self.mass * (cross(rates, self.speed)[i] + acceleration[i]));
        // d/dt of m r x (v + Om x r + r') at constant v, Om; then of the own inertia, which turns with the mass:
        // I' = [w]I - I[w], so (I (Om + w))' = w x I(Om + w) - I (w x (Om + w)) + I w'.
        let whole: Vector<T> =
            std::array::from_fn(|i| self.mass * (v[i] + cross(rates, self.place)[i] + self.speed[i]));
        let orbit = cross(self.speed, whole);
        let carried = cross(self.place, momentum_rate);
        let spin: Vector<T> = std::array::from_fn(|i| rates[i] + self.turning[i]);
        let turned = cross(self.turning, self.own_times(spin));
        let lagged = self.own_times(cross(self.turning, spin));
        let driven = self.own_times(turning_acceleration);
        (momentum_rate, std::array::from_fn(|i| orbit[i] + carried[i] + turned[i] - lagged[i] + driven[i]))
    }
}
