//! Saved states: kept in the instance under a handle, or written out as bytes that another process, machine or version
//! of the same table can read back, bit for bit.
//!
//! The bytes: a mark, the version of this layout, the token of the table of variables, the interface, a hash of the
//! resources (a state is that of one vehicle in one water), the fields of [`Core`] in the order of `fields` (numbers as
//! little-endian IEEE 754), and a CRC-32 of all before it.

use glidepolar_dynamics::Stop;

use super::phase::Phase;
use super::refusal::{Outcome, Refusal};
use super::{Core, Instance, Interface};
use crate::model::Slot;
use crate::model::flight::Integrator;
use crate::model::glider::stop_number;

const MARK: &[u8; 8] = b"glidepol";
const VERSION: u32 = 8;
const RESOURCES_BYTES: usize = 8;
const CHECKSUM_BYTES: usize = 4;

/// A saved state, by the address at which the instance keeps it; nothing is ever read through it.
pub type Handle = usize;

impl Instance {
    /// Saves the state. A handle of this instance is used again, zero makes a new one.
    pub fn save(&mut self, handle: Handle) -> Outcome<Handle> {
        if handle == 0 {
            self.saved.push(Box::new(self.core.clone()));
            return Ok(self.saved.last().map_or(0, |core| address(core)));
        }
        let place = self.place(handle)?;
        *self.saved[place] = self.core.clone();
        Ok(handle)
    }

    /// Goes back to a saved state.
    pub fn restore(&mut self, handle: Handle) -> Outcome {
        self.core = (*self.saved[self.place(handle)?]).clone();
        Ok(())
    }

    /// Forgets a saved state; zero is none.
    pub fn forget(&mut self, handle: Handle) -> Outcome {
        if handle != 0 {
            self.saved.swap_remove(self.place(handle)?);
        }
        Ok(())
    }

    /// A saved state as bytes.
    pub fn serialized(&self, handle: Handle) -> Outcome<Vec<u8>> {
        let mut core = (*self.saved[self.place(handle)?]).clone();
        let mut bytes = self.header();
        bytes.extend(self.resources.to_le_bytes());
        // Fields of a state that exists are all writable.
        let _ = fields(&mut core, &mut Writer(&mut bytes));
        bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
        Ok(bytes)
    }

    /// The saved state that these bytes describe.
    pub fn deserialized(&mut self, bytes: &[u8]) -> Outcome<Handle> {
        let header = self.header();
        let foreign = |why: &str| {
            Err(Refusal::error(format!("these {} bytes are no saved state of this instance: {why}", bytes.len())))
        };
        if bytes.len() < header.len() + RESOURCES_BYTES + CHECKSUM_BYTES {
            return foreign("too few; pass all that was serialized");
        }
        let (content, checksum) = bytes.split_at(bytes.len() - CHECKSUM_BYTES);
        if !content.starts_with(MARK) {
            return foreign("they do not begin like one; they come from another program");
        }
        if crc32fast::hash(content).to_le_bytes() != checksum {
            return foreign("the checksum does not fit; they were cut or changed on the way");
        }
        if !content.starts_with(&header) {
            return foreign("another version of this FMU wrote them, or an instance of the other interface");
        }
        let (resources, content) = content[header.len()..].split_at(RESOURCES_BYTES);
        if resources != self.resources.to_le_bytes() {
            let own = self.vehicle_name.to_string_lossy();
            return foreign(&format!(
                "an instance with another vehicle or other water in its resources wrote them; this one flies \"{own}\""
            ));
        }
        let mut core = self.at_start.clone();
        let mut reader = Reader(content);
        if fields(&mut core, &mut reader).is_none() || !reader.0.is_empty() {
            return foreign("the fields do not fit");
        }
        self.saved.push(Box::new(core));
        Ok(self.saved.last().map_or(0, |core| address(core)))
    }

    fn place(&self, handle: Handle) -> Outcome<usize> {
        self.saved.iter().position(|core| address(core) == handle).ok_or_else(|| {
            Refusal::error("this is no saved state of this instance; it was freed, or saved by another one")
        })
    }

    fn header(&self) -> Vec<u8> {
        let interface = match self.interface {
            Interface::ModelExchange => b'M',
            Interface::CoSimulation => b'C',
        };
        [MARK.as_slice(), &VERSION.to_le_bytes(), self.table().token.as_bytes(), &[interface]].concat()
    }
}

fn address(core: &Core) -> Handle {
    std::ptr::from_ref(core) as usize
}

/// Passes every field of a core through `codec`, to be written or to be read.
fn fields(core: &mut Core, codec: &mut impl Codec) -> Option<()> {
    let phase = codec.byte(core.phase as u8)?;
    core.phase = *Phase::ALL.get(usize::from(phase))?;
    let glider = &mut core.glider;
    let values = &mut glider.values;
    values.parameters = codec.reals(values.parameters)?;
    values.state = codec.reals(values.state)?;
    values.inputs = codec.reals(values.inputs)?;
    values.time_s = codec.real(values.time_s)?;
    for slot in [Slot::Actuation, Slot::Steering] {
        let number = codec.byte(u8::try_from(glider.choice(slot)?).ok()?)?;
        glider.choose(slot, i32::from(number)).then_some(())?;
    }
    let discrete = &mut glider.discrete;
    for stop in [&mut discrete.modes.ballast, &mut discrete.modes.moving_mass] {
        *stop = match codec.byte((stop_number(*stop) + 1) as u8)? {
            0 => Stop::AtMin,
            1 => Stop::Free,
            2 => Stop::AtMax,
            _ => return None,
        };
    }
    for flag in discrete.has_stepped.iter_mut().chain([
        &mut discrete.at_surface,
        &mut discrete.on_seabed,
        &mut glider.uses_column,
        &mut glider.starts_in_trim,
        &mut core.slopes.any,
        &mut core.unsettled,
        &mut core.is_steered,
    ]) {
        *flag = codec.byte(u8::from(*flag))? != 0;
    }
    glider.corners.0 = codec.byte(glider.corners.0)?;
    for order in &mut core.slopes.derivatives {
        *order = codec.reals(*order)?;
    }
    core.slopes.at_end = codec.reals(core.slopes.at_end)?;
    let has_stop = codec.byte(u8::from(core.stop_time_s.is_some()))? != 0;
    let stop = codec.real(core.stop_time_s.unwrap_or(0.0))?;
    core.stop_time_s = has_stop.then_some(stop);
    core.start_time_s = codec.real(core.start_time_s)?;
    let numbers =
        core.integrator.numbers().into_iter().map(|number| codec.real(number)).collect::<Option<Vec<f64>>>()?;
    core.integrator = Integrator::from_numbers(core.glider.model, &numbers)?;
    // A state of an instance with a column cannot go on in one without.
    (!core.glider.uses_column || core.glider.column.is_some()).then_some(())
}

/// Either writes what it is given and gives it back, or gives back what it reads.
trait Codec {
    fn byte(&mut self, value: u8) -> Option<u8>;
    fn real(&mut self, value: f64) -> Option<f64>;

    fn reals<const N: usize>(&mut self, mut values: [f64; N]) -> Option<[f64; N]> {
        for value in &mut values {
            *value = self.real(*value)?;
        }
        Some(values)
    }
}

struct Writer<'a>(&'a mut Vec<u8>);

impl Codec for Writer<'_> {
    fn byte(&mut self, value: u8) -> Option<u8> {
        self.0.push(value);
        Some(value)
    }

    fn real(&mut self, value: f64) -> Option<f64> {
        self.0.extend(value.to_bits().to_le_bytes());
        Some(value)
    }
}

struct Reader<'a>(&'a [u8]);

impl Codec for Reader<'_> {
    fn byte(&mut self, _: u8) -> Option<u8> {
        let (&first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(first)
    }

    fn real(&mut self, _: f64) -> Option<f64> {
        let (first, rest) = self.0.split_first_chunk::<8>()?;
        self.0 = rest;
        Some(f64::from_bits(u64::from_le_bytes(*first)))
    }
}
