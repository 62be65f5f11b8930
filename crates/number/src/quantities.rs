//! Lists of numbers that belong together, each written once as a table: a row gives a number its name, unit, value when
//! nothing is said, bounds, magnitude and meaning. The struct, its arrays and everything else that lists them follow.

/// One row of a table of [`quantities!`](crate::quantities).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Name with its unit, the same in files, fits and the FMU.
    pub name: &'static str,
    /// Unit, written as in the FMI unit definitions (`kg/m3`, `1/rad`; `1` for a pure number).
    pub unit: &'static str,
    /// What it is, in a line.
    pub meaning: &'static str,
    /// Value when nothing is said: the one that leaves it without effect, or a typical one.
    pub default: f64,
    /// Smallest value with a meaning.
    pub min: f64,
    /// Largest value with a meaning.
    pub max: f64,
    /// Its magnitude, the scale on which a tolerance is meant; 1 where the row has none.
    pub nominal: f64,
}

/// Declares a struct `$Name<T>` of numbers, their table `$TABLE` and their count `$COUNT` from rows
/// `name: "unit" = default in min .. max ~ magnitude, "meaning";`. The magnitude may be left out.
#[macro_export]
macro_rules! quantities {
    ($(#[$top:meta])* $Name:ident, $COUNT:ident, $TABLE:ident {
        $($name:ident: $unit:literal = $default:literal in $min:literal .. $max:literal $(~ $nominal:literal)?, $meaning:literal;)*
    }) => {
        $(#[$top])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $Name<T> {
            $(#[doc = concat!($meaning, " \\[", $unit, "\\]")] pub $name: T,)*
        }

        #[doc = concat!("The table of [`", stringify!($Name), "`], in the order of its `as_array`.")]
        pub const $TABLE: &[$crate::Quantity] = &[$($crate::Quantity {
            name: stringify!($name),
            unit: $unit,
            meaning: $meaning,
            default: $default,
            min: $min,
            max: $max,
            nominal: $crate::quantities!(@nominal $($nominal)?),
        },)*];

        #[doc = concat!("How many rows [`", stringify!($TABLE), "`] has.")]
        pub const $COUNT: usize = $TABLE.len();

        impl $Name<f64> {
            /// Names in the order of the table.
            pub const NAMES: &[&str] = &[$(stringify!($name),)*];

            /// The magnitude of each.
            pub const NOMINALS: [f64; $COUNT] = [$($crate::quantities!(@nominal $($nominal)?),)*];
        }

        impl<T: $crate::Number> $Name<T> {
            /// All values, in the order of the table.
            pub fn as_array(&self) -> [T; $COUNT] {
                [$(self.$name,)*]
            }

            /// The inverse of `as_array`.
            pub fn from_array(values: [T; $COUNT]) -> Self {
                let [$($name,)*] = values;
                $Name { $($name,)* }
            }

            /// The same in another kind of number.
            pub fn map<U: $crate::Number>(&self, mut f: impl FnMut(T) -> U) -> $Name<U> {
                $Name { $($name: f(self.$name),)* }
            }

            /// These with `rates` times `duration_s` added.
            pub fn plus(&self, rates: &Self, duration_s: T) -> Self {
                $Name { $($name: self.$name + rates.$name * duration_s,)* }
            }

            /// The row `index` of the table, to read or to set.
            ///
            /// # Panics
            /// When the table has no such row.
            pub fn at(&mut self, index: usize) -> &mut T {
                let slots: [&mut T; $COUNT] = [$(&mut self.$name,)*];
                slots.into_iter().nth(index).expect("a row of the table")
            }
        }

        impl Default for $Name<f64> {
            fn default() -> Self {
                $Name { $($name: $default,)* }
            }
        }
    };
    (@nominal $nominal:literal) => { $nominal };
    (@nominal) => { 1.0 };
}

#[cfg(test)]
mod tests {
    quantities! {
        /// Two numbers.
        Pair, N_PAIR, PAIR {
            length_m: "m" = 2.0 in 0.0 .. 10.0 ~ 0.1, "Length";
            share: "1" = -0.5 in -1.0 .. 1.0, "Share";
        }
    }

    #[test]
    fn table_struct_and_arrays_have_the_rows_in_one_order() {
        let mut pair = Pair::default();
        assert_eq!((N_PAIR, pair.as_array(), Pair::NOMINALS), (2, [2.0, -0.5], [0.1, 1.0]));
        assert_eq!((PAIR[1].name, PAIR[1].unit, PAIR[1].min, PAIR[1].meaning), ("share", "1", -1.0, "Share"));
        *pair.at(0) = 3.0;
        assert_eq!(Pair::from_array(pair.plus(&pair, 2.0).as_array()), pair.map(|value| 3.0 * value));
        assert_eq!(Pair::NAMES, ["length_m", "share"]);
    }
}
