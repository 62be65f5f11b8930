//! How a cycle lies in its bytes: two bits for each sensor, then the new values.

use crate::header::Sensor;

/// The two bits of a sensor: nothing is set. 1 says that the value is as before.
pub(crate) const NOT_SET: u8 = 0;
/// A new value follows.
pub(crate) const NEW: u8 = 2;

/// No slot.
const NONE: u32 = u32::MAX;

/// The layout of the cycles of one list of sensors, and which of them are wanted.
pub(crate) struct Layout {
    sizes: Vec<u8>,
    pub(crate) state_bytes: usize,
    /// For each sensor the slot of its value, if it is wanted.
    slots: Vec<u32>,
    /// For each state byte whether a sensor of it is wanted.
    has_wanted: Vec<bool>,
    /// Sensors that count the time, in slots behind the wanted ones.
    clock: Option<usize>,
    is_big_endian: bool,
}

/// Sensors that hold the time of a cycle.
const CLOCKS: [&str; 2] = ["m_present_time", "sci_m_present_time"];

/// Unix times that a glider can have: 1973 to 2128 \[s\].
const TIMES: std::ops::Range<f64> = 1e8..5e9;

impl Layout {
    pub(crate) fn new(sensors: &[Sensor], wanted: &[String], is_big_endian: bool) -> Self {
        let mut slots = vec![NONE; sensors.len()];
        let mut has_wanted = vec![false; sensors.len().div_ceil(4)];
        for (slot, name) in wanted.iter().enumerate() {
            if let Some(sensor) = sensors.iter().position(|sensor| sensor.name == *name) {
                slots[sensor] = slot as u32;
                has_wanted[sensor / 4] = true;
            }
        }
        Layout {
            sizes: sensors.iter().map(|sensor| sensor.bytes as u8).collect(),
            state_bytes: sensors.len().div_ceil(4),
            slots,
            has_wanted,
            clock: CLOCKS.iter().find_map(|name| sensors.iter().position(|sensor| sensor.name == *name)),
            is_big_endian,
        }
    }

    /// Most bytes of a cycle, its tag among them.
    pub(crate) fn most(&self) -> usize {
        1 + self.state_bytes + self.sizes.iter().map(|size| usize::from(*size)).sum::<usize>()
    }

    /// Bytes of the new values by these state bytes; nothing where two bits are both set, which no glider writes.
    pub(crate) fn data_bytes(&self, states: &[u8]) -> Option<usize> {
        let mut total = 0;
        for (byte, sizes) in states.iter().zip(self.sizes.chunks(4)) {
            if byte & 0xAA == 0 {
                continue;
            }
            for (i, size) in sizes.iter().enumerate() {
                match byte >> (6 - 2 * i) & 3 {
                    NEW => total += usize::from(*size),
                    3 => return None,
                    _ => {}
                }
            }
        }
        Some(total)
    }

    /// Reads the wanted values of a cycle. `memory` holds the last value of each slot, `values` and `states` this cycle's.
    pub(crate) fn read(&self, cycle: &[u8], memory: &mut [f64], values: &mut [f64], states: &mut [u8]) {
        let (states_of, data) = cycle[1..].split_at(self.state_bytes);
        let mut at = 0;
        for (index, byte) in states_of.iter().enumerate() {
            if byte & 0xAA == 0 && !self.has_wanted[index] {
                continue;
            }
            let first = 4 * index;
            for (i, size) in self.sizes[first..].iter().take(4).enumerate() {
                let state = byte >> (6 - 2 * i) & 3;
                let size = usize::from(*size);
                let slot = self.slots[first + i];
                if slot != NONE {
                    let slot = slot as usize;
                    if state == NEW {
                        memory[slot] = self.value(&data[at..at + size]);
                    }
                    states[slot] = state;
                    values[slot] = if state == NOT_SET { f64::NAN } else { memory[slot] };
                }
                if state == NEW {
                    at += size;
                }
            }
        }
    }

    /// The time of a whole cycle, where it is new in it and one that a glider can have.
    pub(crate) fn time(&self, cycle: &[u8]) -> Option<f64> {
        let clock = self.clock?;
        let (states, data) = cycle.get(1..)?.split_at_checked(self.state_bytes)?;
        let mut at = 0;
        for sensor in 0..=clock {
            let is_new = states[sensor / 4] >> (6 - 2 * (sensor % 4)) & 3 == NEW;
            let size = usize::from(self.sizes[sensor]);
            if sensor == clock {
                return is_new
                    .then(|| data.get(at..at + size).map(|bytes| self.value(bytes)))?
                    .filter(|t| TIMES.contains(t));
            }
            at += if is_new { size } else { 0 };
        }
        None
    }

    /// Whether times can be held against each other.
    pub(crate) fn has_clock(&self) -> bool {
        self.clock.is_some()
    }

    fn value(&self, bytes: &[u8]) -> f64 {
        macro_rules! number {
            ($kind:ty, $bytes:expr) => {{
                let array = $bytes.try_into().unwrap_or_default();
                f64::from(if self.is_big_endian {
                    <$kind>::from_be_bytes(array)
                } else {
                    <$kind>::from_le_bytes(array)
                })
            }};
        }
        match bytes.len() {
            1 => f64::from(bytes[0] as i8),
            2 => number!(i16, bytes),
            4 => number!(f32, bytes),
            _ => number!(f64, bytes),
        }
    }
}
