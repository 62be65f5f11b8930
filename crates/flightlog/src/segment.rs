//! Legs: descents and ascents between the turning points of the pressure.
//!
//! A turning point is an extreme from which the pressure then moves away by more than `least_dbar`; smaller reversals
//! (waves at the surface, a pause while climbing) do not end a leg.

/// One descent or ascent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Leg {
    /// First sample, the turning point.
    pub first: usize,
    /// One past the last sample; the next leg begins at the sample before it.
    pub end: usize,
    /// Whether the glider goes down.
    pub descends: bool,
}

/// The legs of one unbroken stretch of pressure.
pub fn legs(pressure_dbar: &[f64], least_dbar: f64) -> Vec<Leg> {
    let mut legs: Vec<Leg> = Vec::new();
    if pressure_dbar.len() < 3 {
        return legs;
    }
    // The extremes seen since the last turning point.
    let (mut lowest, mut highest, mut start) = (0, 0, 0);
    let mut descends: Option<bool> = None;
    for (i, &p) in pressure_dbar.iter().enumerate() {
        if p > pressure_dbar[highest] {
            highest = i;
        }
        if p < pressure_dbar[lowest] {
            lowest = i;
        }
        let fell = pressure_dbar[highest] - p > least_dbar;
        let rose = p - pressure_dbar[lowest] > least_dbar;
        match descends {
            None if rose || fell => {
                // The first extreme opens the first leg; what was before it was no leg.
                descends = Some(rose);
                start = if rose { lowest } else { highest };
                (lowest, highest) = if rose { (lowest, i) } else { (i, highest) };
            }
            Some(true) if fell => {
                legs.push(Leg { first: start, end: highest + 1, descends: true });
                (start, descends, lowest) = (highest, Some(false), i);
            }
            Some(false) if rose => {
                legs.push(Leg { first: start, end: lowest + 1, descends: false });
                (start, descends, highest) = (lowest, Some(true), i);
            }
            _ => {}
        }
    }
    if let Some(descends) = descends {
        legs.push(Leg { first: start, end: pressure_dbar.len(), descends });
    }
    legs
}
