//! The numbers behind a PLY header, one after the other.

use super::header::{Element, Encoding, Kind, Scalar};

/// What has not been read yet.
pub(super) struct Values<'a> {
    encoding: Encoding,
    rest: &'a [u8],
}

impl<'a> Values<'a> {
    pub(super) fn new(encoding: Encoding, rest: &'a [u8]) -> Self {
        Self { encoding, rest }
    }

    /// Refuses an element that announces more rows than there are bytes for, before one of them is read.
    pub(super) fn check_room(&self, element: &Element) -> Result<(), String> {
        let least = |kind| match (self.encoding, kind) {
            // A digit and what parts it from the next.
            (Encoding::Text, _) => 2,
            (_, Kind::Scalar(scalar)) => scalar.bytes(),
            (_, Kind::List { length, .. }) => length.bytes(),
        };
        let row: u64 = element.properties.iter().map(|p| least(p.kind)).sum();
        let held = self.rest.len() as u64;
        // Nothing has to follow the last digit of a text.
        let room = if self.encoding == Encoding::Text { held.saturating_add(1) } else { held };
        match element.rows.checked_mul(row) {
            Some(needed) if needed <= room => Ok(()),
            _ => Err(format!(
                "{} rows of at least {row} bytes announced, {held} bytes there; it is truncated",
                element.rows
            )),
        }
    }

    /// One number a property, in order (0 for lists), and the items of the one list that is asked for.
    pub(super) fn read_row(
        &mut self,
        element: &Element,
        scalars: &mut Vec<f64>,
        mut wanted: Option<(usize, &mut Vec<f64>)>,
    ) -> Result<(), String> {
        scalars.clear();
        for (place, property) in element.properties.iter().enumerate() {
            let (length, item) = match property.kind {
                Kind::Scalar(scalar) => {
                    scalars.push(self.number(scalar)?);
                    continue;
                }
                Kind::List { length, item } => (self.number(length)?, item),
            };
            scalars.push(0.0);
            if !(length >= 0.0 && length.fract() == 0.0) {
                return Err(format!("{length} is not the length of a list"));
            }
            // Nothing is set aside for what a length announces: reading stops where the file does.
            for _ in 0..length as u64 {
                let number = self.number(item)?;
                if let Some((list, items)) = &mut wanted
                    && *list == place
                {
                    items.push(number);
                }
            }
        }
        Ok(())
    }

    /// Passes by all rows of an element.
    pub(super) fn skip(&mut self, element: &Element) -> Result<(), String> {
        let mut scalars = Vec::new();
        // Rows of nothing may be as many as they like.
        let rows = if element.properties.is_empty() { 0 } else { element.rows };
        (0..rows).try_for_each(|row| {
            self.read_row(element, &mut scalars, None).map_err(|reason| format!("row {row}: {reason}"))
        })
    }

    fn number(&mut self, scalar: Scalar) -> Result<f64, String> {
        match self.encoding {
            Encoding::Text => self.word(),
            Encoding::LittleEndian => Ok(match scalar {
                Scalar::I8 => i8::from_le_bytes(self.take()?).into(),
                Scalar::U8 => u8::from_le_bytes(self.take()?).into(),
                Scalar::I16 => i16::from_le_bytes(self.take()?).into(),
                Scalar::U16 => u16::from_le_bytes(self.take()?).into(),
                Scalar::I32 => i32::from_le_bytes(self.take()?).into(),
                Scalar::U32 => u32::from_le_bytes(self.take()?).into(),
                Scalar::F32 => f32::from_le_bytes(self.take()?).into(),
                Scalar::F64 => f64::from_le_bytes(self.take()?),
            }),
            Encoding::BigEndian => Ok(match scalar {
                Scalar::I8 => i8::from_be_bytes(self.take()?).into(),
                Scalar::U8 => u8::from_be_bytes(self.take()?).into(),
                Scalar::I16 => i16::from_be_bytes(self.take()?).into(),
                Scalar::U16 => u16::from_be_bytes(self.take()?).into(),
                Scalar::I32 => i32::from_be_bytes(self.take()?).into(),
                Scalar::U32 => u32::from_be_bytes(self.take()?).into(),
                Scalar::F32 => f32::from_be_bytes(self.take()?).into(),
                Scalar::F64 => f64::from_be_bytes(self.take()?),
            }),
        }
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let (bytes, rest) = self.rest.split_first_chunk().ok_or("it ends here; it is truncated")?;
        self.rest = rest;
        Ok(*bytes)
    }

    /// Text is read in float64 whatever its type: the digits are there.
    fn word(&mut self) -> Result<f64, String> {
        let text = self.rest.trim_ascii_start();
        if text.is_empty() {
            return Err("it ends here; it is truncated".into());
        }
        let end = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
        let (word, rest) = text.split_at(end);
        self.rest = rest;
        let word = String::from_utf8_lossy(word);
        word.parse().map_err(|_| format!("'{word:.40}' is not a number"))
    }
}
