//! Relevance: which misfit is worth acting on.
//!
//! A misfit can be significant and still be of no use to anyone: with enough data every model is wrong. So it is called
//! wrong only where the rms of the fitted misfit, with the share of the noise removed, exceeds the largest of a tenth of
//! the measurement's own scatter and a floor of the quantity. What is below is still reported with its size.

/// Share of a measurement's own scatter below which a misfit is not worth acting on: added in quadrature, a tenth
/// increases the error of a prediction by half a per cent.
pub const SHARE_OF_SCATTER: f64 = 0.1;

/// Standard errors of a one-sided interval, 95 %: of a size the least that it allows must be relevant.
pub const ONE_SIDED: f64 = 1.645;

/// Limits of relevance that a user stated, by the name of the quantity.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Relevance {
    stated: Vec<(String, f64)>,
}

/// A text that states no limit of relevance.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "`{0}` is no limit of relevance: expected QUANTITY=VALUE, the value positive and in the quantity's unit, as in `{1}`"
)]
pub struct NoLimit(String, &'static str);

impl Relevance {
    /// Reads `QUANTITY=VALUE` for the quantities that exist; their names in the JSON, values in their unit.
    ///
    /// # Errors
    /// Where a text is not of this form or names another quantity.
    pub fn parse(texts: &[String], quantities: &[&str], example: &'static str) -> Result<Relevance, NoLimit> {
        let one = |text: &String| {
            let (name, value) = text.split_once('=')?;
            let value = value.trim().parse::<f64>().ok().filter(|value| value.is_finite() && *value >= 0.0)?;
            quantities.contains(&name.trim()).then(|| (name.trim().to_owned(), value))
        };
        let stated = texts.iter().map(|text| one(text).ok_or_else(|| NoLimit(text.clone(), example)));
        Ok(Relevance { stated: stated.collect::<Result<_, _>>()? })
    }

    /// The limit of a quantity: as stated, else the largest of its floor and a tenth of its measurement's scatter.
    pub fn limit(&self, quantity: &str, scatter: f64, floor: f64) -> f64 {
        let stated = self.stated.iter().find(|(name, _)| name == quantity);
        stated.map_or((SHARE_OF_SCATTER * scatter).max(floor), |(_, value)| *value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_is_the_largest_or_as_stated() {
        let none = Relevance::default();
        assert!((none.limit("w", 5e-3, 1e-3) - 1e-3).abs() < 1e-15);
        assert!((none.limit("w", 5e-2, 1e-3) - 5e-3).abs() < 1e-15);
        let stated = Relevance::parse(&["w=0.002".to_owned()], &["w", "v"], "w=0.002").unwrap();
        assert_eq!(stated.limit("w", 5e-2, 1e-3), 0.002);
        assert_eq!(stated.limit("v", 1e-3, 3e-3), 3e-3);
        for wrong in ["w", "w=", "w=-1", "x=1", "w=nan", "=1"] {
            assert!(Relevance::parse(&[wrong.to_owned()], &["w", "v"], "w=0.002").is_err(), "{wrong}");
        }
    }
}
