//! Diagnosis: what the model gets wrong, why, the extension, the gain. The engine knows numbers only
//! ([`glidepolar_inference`]); [`sea`] hands it flight logs, the tank its campaigns.

pub mod sea;

pub use glidepolar_inference::*;
