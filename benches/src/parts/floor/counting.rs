//! A number that counts what is done with it, to send through the very equations that are measured.

use std::cell::Cell;
use std::fmt;
use std::iter::{Product, Sum};
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, RemAssign, Sub, SubAssign};

use glidepolar::Number;
use glidepolar::number::functions::Function;
use num_dual::{DualNum, DualStruct, Mappable};
use num_traits::{FromPrimitive, Inv, Num, One, Signed, Zero};

/// Kinds of operations that are counted apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Add,
    Multiply,
    Divide,
    SquareRoot,
    /// Both at once.
    SineCosine,
    ArcTangent,
    Exponential,
    Logarithm,
    /// Anything else; the right-hand side has none.
    Other,
}

/// All of them.
pub const KINDS: [Kind; 9] = [
    Kind::Add,
    Kind::Multiply,
    Kind::Divide,
    Kind::SquareRoot,
    Kind::SineCosine,
    Kind::ArcTangent,
    Kind::Exponential,
    Kind::Logarithm,
    Kind::Other,
];

impl Kind {
    pub fn words(self) -> &'static str {
        match self {
            Kind::Add => "additions",
            Kind::Multiply => "multiplications",
            Kind::Divide => "divisions",
            Kind::SquareRoot => "square roots",
            Kind::SineCosine => "pairs of sine and cosine",
            Kind::ArcTangent => "arc tangents",
            Kind::Exponential => "exponentials",
            Kind::Logarithm => "logarithms",
            Kind::Other => "other functions",
        }
    }
}

/// How many of each kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Tally([u64; KINDS.len()]);

thread_local! {
    static DONE: Cell<Tally> = const { Cell::new(Tally([0; KINDS.len()])) };
}

impl Tally {
    /// All that this thread has counted so far.
    pub fn now() -> Self {
        DONE.get()
    }

    /// What came since another time.
    pub fn since(&self, before: &Tally) -> Tally {
        Tally(std::array::from_fn(|i| self.0[i] - before.0[i]))
    }

    pub fn count(&self, kind: Kind) -> u64 {
        self.0[kind as usize]
    }
}

fn did(kind: Kind) {
    let mut done = DONE.get();
    done.0[kind as usize] += 1;
    DONE.set(done);
}

/// An `f64` whose operations are counted.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Counted(f64);

macro_rules! operation {
    ($($trait:ident $method:ident $assign:ident $assign_method:ident $kind:ident;)*) => {$(
        impl $trait for Counted {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                did(Kind::$kind);
                Counted(self.0.$method(other.0))
            }
        }
        impl $trait<&Counted> for Counted {
            type Output = Self;
            fn $method(self, other: &Self) -> Self {
                self.$method(*other)
            }
        }
        impl $trait<f64> for Counted {
            type Output = Self;
            fn $method(self, other: f64) -> Self {
                self.$method(Counted(other))
            }
        }
        impl $assign for Counted {
            fn $assign_method(&mut self, other: Self) {
                *self = self.$method(other);
            }
        }
        impl $assign<f64> for Counted {
            fn $assign_method(&mut self, other: f64) {
                *self = self.$method(other);
            }
        }
    )*};
}

operation! {
    Add add AddAssign add_assign Add;
    Sub sub SubAssign sub_assign Add;
    Mul mul MulAssign mul_assign Multiply;
    Div div DivAssign div_assign Divide;
    Rem rem RemAssign rem_assign Other;
}

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        Counted(-self.0)
    }
}

impl From<f64> for Counted {
    fn from(value: f64) -> Self {
        Counted(value)
    }
}

impl fmt::Display for Counted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl PartialEq<f64> for Counted {
    fn eq(&self, other: &f64) -> bool {
        self.0 == *other
    }
}

impl PartialOrd<f64> for Counted {
    fn partial_cmp(&self, other: &f64) -> Option<std::cmp::Ordering> {
        self.0.partial_cmp(other)
    }
}

impl Zero for Counted {
    fn zero() -> Self {
        Counted(0.0)
    }
    fn is_zero(&self) -> bool {
        self.0 == 0.0
    }
}

impl One for Counted {
    fn one() -> Self {
        Counted(1.0)
    }
}

impl Num for Counted {
    type FromStrRadixErr = num_traits::ParseFloatError;
    fn from_str_radix(text: &str, radix: u32) -> Result<Self, Self::FromStrRadixErr> {
        f64::from_str_radix(text, radix).map(Counted)
    }
}

impl Signed for Counted {
    fn abs(&self) -> Self {
        Counted(self.0.abs())
    }
    fn abs_sub(&self, other: &Self) -> Self {
        if self.0 <= other.0 { Counted(0.0) } else { *self - *other }
    }
    fn signum(&self) -> Self {
        Counted(self.0.signum())
    }
    fn is_positive(&self) -> bool {
        self.0.is_sign_positive()
    }
    fn is_negative(&self) -> bool {
        self.0.is_sign_negative()
    }
}

impl Inv for Counted {
    type Output = Self;
    fn inv(self) -> Self {
        DualNum::recip(&self)
    }
}

impl Sum for Counted {
    fn sum<I: Iterator<Item = Self>>(values: I) -> Self {
        values.fold(Counted(0.0), Add::add)
    }
}

impl<'a> Sum<&'a Counted> for Counted {
    fn sum<I: Iterator<Item = &'a Self>>(values: I) -> Self {
        values.copied().sum()
    }
}

impl Product for Counted {
    fn product<I: Iterator<Item = Self>>(values: I) -> Self {
        values.fold(Counted(1.0), Mul::mul)
    }
}

impl FromPrimitive for Counted {
    fn from_i64(value: i64) -> Option<Self> {
        f64::from_i64(value).map(Counted)
    }
    fn from_u64(value: u64) -> Option<Self> {
        f64::from_u64(value).map(Counted)
    }
    fn from_f64(value: f64) -> Option<Self> {
        Some(Counted(value))
    }
}

impl DualStruct for Counted {
    type Real = f64;
    type Inner = f64;
    fn re(&self) -> f64 {
        self.0
    }
    fn from_inner(inner: &f64) -> Self {
        Counted(*inner)
    }
}

impl Mappable<Counted> for Counted {
    type Output<O> = O;
    fn map_dual<M: Fn(Counted) -> O, O>(self, function: M) -> O {
        function(self)
    }
}

macro_rules! functions {
    ($($name:ident $kind:ident;)*) => {$(
        fn $name(&self) -> Self {
            did(Kind::$kind);
            Counted(self.0.$name())
        }
    )*};
}

macro_rules! bessel {
    ($($name:ident)*) => {$(
        fn $name(&self) -> Self {
            did(Kind::Other);
            Counted(DualNum::$name(&self.0))
        }
    )*};
}

impl Number for Counted {
    fn value(self) -> f64 {
        self.0
    }

    fn is_constant_zero(&self) -> bool {
        self.0 == 0.0
    }

    fn function_value(value: f64, function: Function) -> Self {
        did(match function {
            Function::SineCosine => Kind::SineCosine,
            Function::ArcTangent => Kind::ArcTangent,
            Function::Exponential => Kind::Exponential,
            Function::Logarithm => Kind::Logarithm,
            Function::Other => Kind::Other,
        });
        Counted(value)
    }
}

// No derivatives: the equations then take the same way as with plain numbers.
impl DualNum for Counted {
    type Primitive = f64;
    const NDERIV: usize = 0;
    type InnerDual = f64;

    fn from_re(re: f64) -> Self {
        Counted(re)
    }
    fn scale(self, factor: &f64) -> Self {
        self * *factor
    }
    fn powi(&self, n: i32) -> Self {
        did(Kind::Other);
        Counted(self.0.powi(n))
    }
    fn powf(&self, n: f64) -> Self {
        did(Kind::Other);
        Counted(self.0.powf(n))
    }
    fn log(&self, base: f64) -> Self {
        did(Kind::Other);
        Counted(self.0.log(base))
    }
    fn sin_cos(&self) -> (Self, Self) {
        did(Kind::SineCosine);
        let (sin, cos) = self.0.sin_cos();
        (Counted(sin), Counted(cos))
    }
    fn atan2(&self, other: Self) -> Self {
        did(Kind::ArcTangent);
        Counted(self.0.atan2(other.0))
    }

    functions! {
        recip Divide;
        sqrt SquareRoot;
        cbrt Other;
        exp Exponential;
        exp2 Other;
        exp_m1 Other;
        ln Logarithm;
        log2 Other;
        log10 Other;
        ln_1p Other;
        sin SineCosine;
        cos SineCosine;
        tan Other;
        asin Other;
        acos Other;
        atan Other;
        sinh Other;
        cosh Other;
        tanh Other;
        asinh Other;
        acosh Other;
        atanh Other;
    }
    bessel! { sph_j0 sph_j1 sph_j2 }
}
