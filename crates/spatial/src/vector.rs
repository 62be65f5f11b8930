//! Three numbers as a vector: sum, multiple, products.

use glidepolar_number::{Number, functions};

pub type Vector<T> = [T; 3];

pub fn add<T: Number>(a: Vector<T>, b: Vector<T>) -> Vector<T> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub fn scale<T: Number>(by: T, a: Vector<T>) -> Vector<T> {
    [by * a[0], by * a[1], by * a[2]]
}

pub fn dot<T: Number>(a: Vector<T>, b: Vector<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross<T: Number>(a: Vector<T>, b: Vector<T>) -> Vector<T> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Roll, pitch and heading as the rotation from body axes to north, east and down, by its rows.
pub struct Attitude<T> {
    rows: [Vector<T>; 3],
    /// Sine and cosine.
    pub roll: (T, T),
    /// Sine and cosine.
    pub pitch: (T, T),
}

impl<T: Number> Attitude<T> {
    pub fn new(roll: T, pitch: T, heading: T) -> Self {
        let (roll, pitch) = (functions::sin_cos(roll), functions::sin_cos(pitch));
        let ((sr, cr), (sp, cp), (sh, ch)) = (roll, pitch, functions::sin_cos(heading));
        Attitude {
            roll,
            pitch,
            rows: [
                [cp * ch, sr * sp * ch - cr * sh, cr * sp * ch + sr * sh],
                [cp * sh, sr * sp * sh + cr * ch, cr * sp * sh - sr * ch],
                [-sp, sr * cp, cr * cp],
            ],
        }
    }

    /// The direction of gravity in body axes.
    pub fn down(&self) -> Vector<T> {
        self.rows[2]
    }

    /// From body axes to north, east, down.
    pub fn to_earth(&self, body: Vector<T>) -> Vector<T> {
        self.rows.map(|row| dot(row, body))
    }

    /// From north, east, down to body axes.
    pub fn to_body(&self, earth: Vector<T>) -> Vector<T> {
        std::array::from_fn(|j| earth[0] * self.rows[0][j] + earth[1] * self.rows[1][j] + earth[2] * self.rows[2][j])
    }
}
